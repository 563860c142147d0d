// next_leaves(): the SIMD version of Separation's comparisons, compiled for each instruction set by Highway. Separation::apart() is
// the specification.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "narrow_phase/mesh/mesh_walk_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "narrow_phase/mesh/mesh_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Continues the walk. test.apart(a, b) is true if the boxes of two nodes are farther apart than the walk's reach; the walk skips them.
template <typename Test>
unsigned walk_with(const Test& test, MeshWalk& walk, std::span<NodePair> leaves) {
    unsigned found = 0;
    while (!walk.waiting.empty() && found < leaves.size()) {
        const NodePair at = walk.waiting.pop();
        const MeshNode &node_a = walk.nodes_a[at.a], &node_b = walk.nodes_b[at.b];
        if (node_a.is_leaf() && node_b.is_leaf()) {
            leaves[found++] = at;
            continue;
        }
        const auto children = children_of(at, node_a, node_b, walk.separation);
        for (const NodePair& child : {children[1], children[0]}) {
            walk.waiting.push_if(child, !test.apart(walk.nodes_a[child.a], walk.nodes_b[child.b]));
        }
    }
    return found;
}

#if HWY_TARGET == HWY_SCALAR

struct ScalarTest {
    explicit ScalarTest(const MeshWalk& walk) : separation(walk.separation), reach(walk.reach) {}
    bool apart(const MeshNode& a, const MeshNode& b) const { return separation.apart(a, b, reach); }

    const Separation& separation;
    float reach;
};

unsigned next_leaves_simd(MeshWalk& walk, std::span<NodePair> leaves) {
    return walk_with(ScalarTest(walk), walk, leaves);
}

#else

using D = hn::FixedTag<float, 4>;
using V = hn::Vec<D>;

/// SIMD version of Separation::Map.
struct VectorMap {
    explicit VectorMap(const Separation::Map& map) {
        for (int i = 0; i < 3; ++i) {
            column[i] = hn::Load(D(), map.column[i].at);
            magnitude[i] = hn::Load(D(), map.magnitude[i].at);
        }
    }
    static V combine(const V (&columns)[3], const float (&by)[3]) {
        const V xy = hn::Add(hn::Mul(columns[0], hn::Set(D(), by[0])), hn::Mul(columns[1], hn::Set(D(), by[1])));
        return hn::Add(xy, hn::Mul(columns[2], hn::Set(D(), by[2])));
    }
    V centre(const MeshNode& node) const { return combine(column, node.centre); }
    V half(const MeshNode& node) const { return combine(magnitude, node.half); }

    V column[3], magnitude[3];
};

/// SIMD version of Separation::Axes.
struct VectorAxes {
    explicit VectorAxes(const Separation::Axes& axes)
        : other(axes.other),
          offset(hn::Load(D(), axes.offset.at)),
          slack(hn::Load(D(), axes.slack.at)),
          scale(hn::Load(D(), axes.scale.at)) {}

    V gaps(V own_centre, V own_half, const MeshNode& node) const {
        const V between = hn::Abs(hn::Sub(hn::Add(offset, other.centre(node)), own_centre));
        const V halves = hn::Add(hn::Add(other.half(node), own_half), slack);
        return hn::Mul(hn::Sub(between, halves), scale);
    }

    VectorMap other;
    V offset, slack, scale;
};

struct OwnTest {
    explicit OwnTest(const MeshWalk& walk)
        : of_a(walk.separation.of_a()), of_b(walk.separation.of_b()), reach(hn::Set(D(), walk.reach)) {}

    bool apart(const MeshNode& a, const MeshNode& b) const {
        const D d;
        const V in_a = of_a.gaps(hn::Load(d, a.centre), hn::Load(d, a.half), b);
        const V in_b = of_b.gaps(hn::Load(d, b.centre), hn::Load(d, b.half), a);
        return !hn::AllFalse(d, hn::Or(hn::Gt(in_a, reach), hn::Gt(in_b, reach)));
    }

    VectorAxes of_a, of_b;
    V reach;
};

struct WorldTest {
    explicit WorldTest(const MeshWalk& walk)
        : axes(*walk.separation.of_world()), own(walk.separation.of_world()->own), reach(hn::Set(D(), walk.reach)) {}

    bool apart(const MeshNode& a, const MeshNode& b) const {
        return !hn::AllFalse(D(), hn::Gt(axes.gaps(own.centre(a), own.half(a), b), reach));
    }

    VectorAxes axes;
    VectorMap own;
    V reach;
};

unsigned next_leaves_simd(MeshWalk& walk, std::span<NodePair> leaves) {
    return walk.separation.of_world() ? walk_with(WorldTest(walk), walk, leaves)
                                      : walk_with(OwnTest(walk), walk, leaves);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(next_leaves_simd);

unsigned next_leaves(MeshWalk& walk, std::span<NodePair> leaves) {
    return HWY_DYNAMIC_DISPATCH(next_leaves_simd)(walk, leaves);
}

}  // namespace octopair

#endif  // HWY_ONCE
