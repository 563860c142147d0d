// What a mesh encloses: a ray from the point, in the world, along x, and how the closed parts wind around it.
#include <algorithm>
#include <cmath>

#include "geometry/exact/orientation.hpp"
#include "geometry/exact/ray_parity.hpp"
#include "geometry/shape/mesh_leaves.hpp"
#include "geometry/shape/mesh_pair.hpp"

namespace octopair {

namespace {

/// Boxes of a posed mesh, in the world: whether the ray may pass them.
class RayTest {
public:
    RayTest(const PosedMesh& mesh, const Point3d& from) : pose_(mesh.pose), from_(from) {
        origin_ = vector::posed(mesh.pose, mesh.tree.origin);
        const MeshNode& root = mesh.tree.nodes[0];
        for (int row = 0; row < 3; ++row) {
            double made_of = std::abs(pose_.rows[row][3]) + std::abs(from[row]);
            for (int axis = 0; axis < 3; ++axis) {
                made_of +=
                    std::abs(pose_.rows[row][axis]) *
                    (std::abs(mesh.tree.origin[axis]) + std::abs(double(root.centre[axis])) + double(root.half[axis]));
            }
            slack_[row] = 64 * 0x1p-53 * made_of;  // fewer than 64 roundings
        }
    }

    bool may_pass(const MeshNode& node) const {
        for (int row = 0; row < 3; ++row) {
            const auto& r = pose_.rows[row];
            const double centre = origin_[row] + (r[0] * double(node.centre[0]) + r[1] * double(node.centre[1]) +
                                                  r[2] * double(node.centre[2]));
            const double half = std::abs(r[0]) * double(node.half[0]) + std::abs(r[1]) * double(node.half[1]) +
                                std::abs(r[2]) * double(node.half[2]) + slack_[row];
            if (centre + half < from_[row]) return false;
            if (row > 0 && centre - half > from_[row]) return false;
        }
        return true;
    }

private:
    const Pose& pose_;
    Point3d from_, origin_, slack_;
};

/// How often the surface was crossed: outward less inward, and of what does not know its outside, how often in all.
struct Crossings {
    std::int64_t winding = 0;
    std::uint64_t unoriented = 0;
};

void count_leaf(const PosedMesh& mesh, const MeshNode& leaf, const Point3d& from, Crossings& crossings) {
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const MeshParts::Side side = mesh.tree.parts.sides[i];
        if (side == MeshParts::Side::open) continue;
        const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
        if (!ray_crosses(from, triangle, 0)) continue;
        if (side == MeshParts::Side::unoriented) {
            ++crossings.unoriented;
        } else {
            crossings.winding += line_side(triangle[0], triangle[1], triangle[2], 0);
        }
    }
}

}  // namespace

bool encloses(const PosedMesh& mesh, const Point3d& point) {
    if (!mesh.tree.parts.any_closed) return false;
    const RayTest ray(mesh, point);
    Crossings crossings;
    NodeStack<std::uint32_t> waiting;
    waiting.push(0);
    while (!waiting.empty()) {
        const MeshNode& node = mesh.tree.nodes[waiting.pop()];
        if (!ray.may_pass(node)) continue;
        if (node.is_leaf()) {
            count_leaf(mesh, node, point, crossings);
        } else {
            waiting.push(node.first + 1);
            waiting.push(node.first);
        }
    }
    return crossings.winding != 0 || crossings.unoriented % 2 != 0;
}

bool encloses_part(const PosedMesh& outer, const PosedMesh& inner) {
    const auto& corners = inner.tree.parts.corners;
    return outer.tree.parts.any_closed && std::any_of(corners.begin(), corners.end(), [&](const Point3d& corner) {
               return encloses(outer, vector::posed(inner.pose, corner));
           });
}

bool holds_whole(const PosedMesh& outer, const PosedMesh& inner) {
    const auto& corners = inner.tree.parts.corners;
    return !corners.empty() && !encloses_part(inner, outer) &&
           std::all_of(corners.begin(), corners.end(),
                       [&](const Point3d& corner) { return encloses(outer, vector::posed(inner.pose, corner)); });
}

}  // namespace octopair
