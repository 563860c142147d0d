#include "narrow_phase/mesh/mesh_convex.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"

namespace octopair {

namespace {

/// Calls visit(place in the tree's order, triangle) for the triangles near the solid, until `visit` returns false.
template <typename Visit>
void visit_near(const PosedMesh& mesh, const BoxedSolid& solid, const Visit& visit) {
    visit_leaves(mesh, solid.box, 0, [&](const MeshNode& leaf, const MeshNode&) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            if (!visit(i, mesh.tree.world_triangle(mesh.pose, i))) return false;
        }
        return true;
    });
}

}  // namespace

bool surface_meets(const PosedMesh& mesh, const BoxedSolid& solid) {
    bool meets = false;
    visit_near(mesh, solid, [&](std::uint32_t, const Triangle3d& triangle) {
        meets = convex_meet(PosedConvex(triangle), solid.posed());
        return !meets;
    });
    return meets;
}

void visit_meeting_triangles(const PosedMesh& mesh, const BoxedSolid& solid,
                             const std::function<bool(std::uint32_t at, const Triangle3d&)>& visit) {
    visit_near(mesh, solid, [&](std::uint32_t at, const Triangle3d& triangle) {
        return !convex_meet(PosedConvex(triangle), solid.posed()) || visit(at, triangle);
    });
}

bool encloses_solid(const PosedMesh& mesh, const BoxedSolid& solid) {
    return encloses(mesh, vector::posed(solid.box.pose, support(solid.solid, {1, 0, 0})));
}

bool contains_mesh(const BoxedSolid& solid, const PosedMesh& mesh) {
    const auto held = [&](std::uint32_t vertex) {
        const Point3d place = vector::posed(mesh.pose, mesh.tree.vertices[vertex]);
        return convex_contains(solid.posed(), PosedConvex(place));
    };
    const auto& triangles = mesh.tree.triangles;
    return !triangles.empty() && std::all_of(triangles.begin(), triangles.end(), [&](const auto& corners) {
        return std::all_of(corners.begin(), corners.end(), held);
    });
}

std::optional<ConvexGap> surface_gap(const PosedMesh& mesh, const BoxedSolid& solid, double most) {
    if (mesh.tree.nodes.empty()) return std::nullopt;
    std::optional<ConvexGap> best;
    MeshWalk walk(mesh, solid.box, reach_above(most));
    std::array<NodePair, 1> at;
    while (next_leaves(walk, at) > 0) {
        const MeshNode& leaf = mesh.tree.nodes[at[0].a];
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
            const ConvexGap gap = convex_gap(PosedConvex(triangle), solid.posed());
            if (gap.at_least > most || (best && gap.distance >= best->distance)) continue;
            best = gap;
            most = std::min(most, gap.distance);
            walk.reach = reach_above(most);
        }
    }
    return best;
}

}  // namespace octopair
