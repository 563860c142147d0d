#include "narrow_phase/mesh/mesh_pair.hpp"

#include <algorithm>

#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"

namespace octopair {

namespace {

/// Calls visit(i, j) for triangle i of leaf a and triangle j of leaf b that meet, until `visit` returns false.
template <typename Visit>
bool visit_meeting(const WorldLeaf& a, const WorldLeaf& b, const Visit& visit) {
    for (std::uint32_t i = 0; i < a.count(); ++i) {
        for (std::uint32_t j = 0; j < b.count(); ++j) {
            if (!boxes_overlap(a.box(i), b.box(j)) || !triangles_meet(a.triangle(i), b.triangle(j))) continue;
            if (!visit(i, j)) return false;
        }
    }
    return true;
}

/// Finds the smallest distance of two surfaces by a depth-first traversal, which visits the nearer of two children first.
class GapSearch {
public:
    GapSearch(const PosedMesh& a, const PosedMesh& b, double most)
        : a_(a), b_(b), separation_(boxes_of(a), boxes_of(b)), most_(most) {}

    std::optional<SurfaceGap> run() {
        NodeStack<Waiting> waiting;
        waiting.push(with_bound({0, 0}));
        while (!waiting.empty()) {
            const Waiting at = waiting.pop();
            if (double(at.least) > most_) continue;
            const MeshNode &node_a = a_.tree.nodes[at.nodes.a], &node_b = b_.tree.nodes[at.nodes.b];
            if (node_a.is_leaf() && node_b.is_leaf()) {
                test_leaves(node_a, node_b);
                continue;
            }
            const auto children = children_of(at.nodes, node_a, node_b, separation_);
            const Waiting first = with_bound(children[0]), second = with_bound(children[1]);
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

    Waiting with_bound(const NodePair& nodes) const {
        return {nodes, separation_.min_distance(a_.tree.nodes[nodes.a], b_.tree.nodes[nodes.b])};
    }

    void test_leaves(const MeshNode& node_a, const MeshNode& node_b) {
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
        visit_meeting(WorldLeaf(a, node_a), WorldLeaf(b, node_b), [&](std::uint32_t, std::uint32_t) {
            meet = true;
            return false;
        });
        return !meet;
    });
    return meet;
}

void visit_meeting_triangles(const PosedMesh& a, const PosedMesh& b,
                             const std::function<bool(const MeetingTriangles&)>& visit) {
    visit_leaves(a, b, 0, [&](const MeshNode& node_a, const MeshNode& node_b) {
        const WorldLeaf leaf_a(a, node_a), leaf_b(b, node_b);
        return visit_meeting(leaf_a, leaf_b, [&](std::uint32_t i, std::uint32_t j) {
            const std::uint32_t at_a = leaf_a.place(i), at_b = leaf_b.place(j);
            return visit(
                {at_a, at_b, a.tree.numbers[at_a], b.tree.numbers[at_b], leaf_a.triangle(i), leaf_b.triangle(j)});
        });
    });
}

std::optional<SurfaceGap> surface_gap(const PosedMesh& a, const PosedMesh& b, double most) {
    if (a.tree.nodes.empty() || b.tree.nodes.empty()) return std::nullopt;
    return GapSearch(a, b, most).run();
}

}  // namespace octopair
