#include "narrow_phase/mesh/mesh_pair.hpp"

#include <algorithm>

#include "narrow_phase/exact/triangle_gap.hpp"
#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"

namespace octopair {

namespace {

/// Calls tell(triangle of a, triangle of b), as places in the leaves, for triangles that meet, until it returns false.
template <typename Tell>
bool tell_meeting(const WorldLeaf& a, const WorldLeaf& b, const Tell& tell) {
    for (std::uint32_t i = 0; i < a.count(); ++i) {
        for (std::uint32_t j = 0; j < b.count(); ++j) {
            if (!boxes_overlap(a.box(i), b.box(j)) || !triangles_meet(a.triangle(i), b.triangle(j))) continue;
            if (!tell(i, j)) return false;
        }
    }
    return true;
}

/// The search for the least distance: best first where two children are to choose from.
class GapSearch {
public:
    GapSearch(const PosedMesh& a, const PosedMesh& b, double most)
        : a_(a), b_(b), separation_(boxes_of(a), boxes_of(b)), most_(most) {}

    std::optional<SurfaceGap> run() {
        NodeStack<Waiting> waiting;
        waiting.push(weigh({0, 0}));
        while (!waiting.empty()) {
            const Waiting at = waiting.pop();
            if (double(at.least) > most_) continue;
            const MeshNode &node_a = a_.tree.nodes[at.nodes.a], &node_b = b_.tree.nodes[at.nodes.b];
            if (node_a.is_leaf() && node_b.is_leaf()) {
                look_at(node_a, node_b);
                continue;
            }
            const auto children = children_of(at.nodes, node_a, node_b, separation_);
            const Waiting first = weigh(children[0]), second = weigh(children[1]);
            waiting.push(first.least <= second.least ? second : first);
            waiting.push(first.least <= second.least ? first : second);
        }
        return best_;
    }

private:
    struct Waiting {
        NodePair nodes;
        float least;
    };

    Waiting weigh(const NodePair& nodes) const {
        return {nodes, separation_.least_distance(a_.tree.nodes[nodes.a], b_.tree.nodes[nodes.b])};
    }

    void look_at(const MeshNode& node_a, const MeshNode& node_b) {
        const WorldLeaf leaf_a(a_, node_a), leaf_b(b_, node_b);
        for (std::uint32_t i = 0; i < leaf_a.count(); ++i) {
            for (std::uint32_t j = 0; j < leaf_b.count(); ++j) {
                const TriangleGap gap = triangle_gap(leaf_a.triangle(i), leaf_b.triangle(j));
                if (!(gap.distance <= most_) || (best_ && gap.distance >= best_->distance)) continue;
                best_ = SurfaceGap{gap.distance, gap.nearest, a_.tree.numbers[leaf_a.place(i)],
                                   b_.tree.numbers[leaf_b.place(j)]};
                most_ = gap.distance;
            }
        }
    }

    const PosedMesh &a_, &b_;
    Separation separation_;
    double most_;
    std::optional<SurfaceGap> best_;
};

}  // namespace

bool surfaces_meet(const PosedMesh& a, const PosedMesh& b) {
    bool meet = false;
    visit_leaves(a, b, 0, [&](const MeshNode& node_a, const MeshNode& node_b) {
        tell_meeting(WorldLeaf(a, node_a), WorldLeaf(b, node_b), [&](std::uint32_t, std::uint32_t) {
            meet = true;
            return false;
        });
        return !meet;
    });
    return meet;
}

void visit_meeting_triangles(const PosedMesh& a, const PosedMesh& b,
                             const std::function<bool(const MeetingTriangles&)>& tell) {
    visit_leaves(a, b, 0, [&](const MeshNode& node_a, const MeshNode& node_b) {
        const WorldLeaf leaf_a(a, node_a), leaf_b(b, node_b);
        return tell_meeting(leaf_a, leaf_b, [&](std::uint32_t i, std::uint32_t j) {
            const std::uint32_t at_a = leaf_a.place(i), at_b = leaf_b.place(j);
            constexpr auto oriented = MeshParts::Side::oriented;
            return tell({a.tree.numbers[at_a], b.tree.numbers[at_b], leaf_a.triangle(i), leaf_b.triangle(j),
                         a.tree.parts.sides[at_a] == oriented && b.tree.parts.sides[at_b] == oriented});
        });
    });
}

std::optional<SurfaceGap> surface_gap(const PosedMesh& a, const PosedMesh& b, double most) {
    if (a.tree.nodes.empty() || b.tree.nodes.empty()) return std::nullopt;
    return GapSearch(a, b, most).run();
}

}  // namespace octopair
