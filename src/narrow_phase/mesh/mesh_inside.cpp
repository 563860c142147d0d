// encloses(): point in mesh test, by a ray from the point along the world's x axis and the winding number of closed parts.
#include <algorithm>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/ray_parity.hpp"
#include "narrow_phase/mesh/mesh_leaves.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/world_boxes.hpp"

namespace octopair {

namespace {

Box3d box_of(const Point3d& from) { return {{from[0], from[1], from[2]}, {from[0], from[1], from[2]}}; }
Box3d box_of(const NearbyPoint& from) { return from.box(); }

/// Returns false only if all rays in the positive direction of x that start in the box `from` miss the node's box.
bool may_pass(const WorldBoxes& boxes, const MeshNode& node, const Box3d& from) {
    for (int row = 0; row < 3; ++row) {
        const auto [low, high] = boxes.span(node, row);
        if (high < from.min[row]) return false;
        if (row > 0 && low > from.max[row]) return false;
    }
    return true;
}

/// Number of crossings of the ray and the surface.
struct Crossings {
    std::int64_t winding = 0;      ///< oriented parts: outward minus inward crossings
    std::uint64_t unoriented = 0;  ///< closed parts without a consistent orientation: all crossings
};

template <typename From>
void count_leaf(const PosedMesh& mesh, const MeshNode& leaf, const From& from, Crossings& crossings) {
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const MeshParts::Side side = mesh.tree.parts.sides[i];
        if (side == MeshParts::Side::open) continue;
        const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
        if (!ray_crosses(from, triangle)) continue;
        if (side == MeshParts::Side::unoriented) {
            ++crossings.unoriented;
        } else {
            crossings.winding += line_side(triangle[0], triangle[1], triangle[2], 0);
        }
    }
}

template <typename From>
bool encloses_any(const PosedMesh& mesh, const From& point) {
    if (!mesh.tree.parts.any_closed) return false;
    const WorldBoxes boxes(mesh);
    const Box3d from = box_of(point);
    Crossings crossings;
    NodeStack<std::uint32_t> waiting;
    waiting.push(0);
    while (!waiting.empty()) {
        const MeshNode& node = mesh.tree.nodes[waiting.pop()];
        if (!may_pass(boxes, node, from)) continue;
        if (node.is_leaf()) {
            count_leaf(mesh, node, point, crossings);
        } else {
            waiting.push(node.first + 1);
            waiting.push(node.first);
        }
    }
    return crossings.winding != 0 || crossings.unoriented % 2 != 0;
}

}  // namespace

bool encloses(const PosedMesh& mesh, const Point3d& point) { return encloses_any(mesh, point); }

bool encloses(const PosedMesh& mesh, const NearbyPoint& point) { return encloses_any(mesh, point); }

bool encloses_part(const PosedMesh& outer, const PosedMesh& inner) {
    const auto& corners = inner.tree.parts.corners;
    return outer.tree.parts.any_closed && std::any_of(corners.begin(), corners.end(), [&](const Point3d& corner) {
               return encloses(outer, vector::posed(inner.pose, corner));
           });
}

bool contains_mesh(const PosedMesh& outer, const PosedMesh& inner) {
    const auto& corners = inner.tree.parts.corners;
    return !corners.empty() && !encloses_part(inner, outer) &&
           std::all_of(corners.begin(), corners.end(),
                       [&](const Point3d& corner) { return encloses(outer, vector::posed(inner.pose, corner)); });
}

}  // namespace octopair
