// How far a point is from the surface of a posed mesh.
#pragma once

#include <limits>

#include "geometry/exact/triangle_gap.hpp"
#include "geometry/shape/mesh_leaves.hpp"

namespace octopair {

/// A mesh of one point, to be put anywhere.
class Probe {
public:
    Probe() {
        tree_.vertices.resize(1);
        tree_.triangles = {{0, 0, 0}};
        tree_.numbers = {0};
        tree_.nodes = {{{0, 0, 0}, 0, {0, 0, 0}, 1}};
    }

    void put(const Point3d& point) { tree_.vertices[0] = tree_.origin = point; }

    /// 0 of a point on the surface; infinite where there is none.
    double distance(const PosedMesh& mesh) const {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const auto gap = surface_gap({tree_, pose_}, mesh, infinity);
        return gap ? gap->distance : infinity;
    }

    /// Whether that is at most so much; much cheaper, where it is less.
    bool is_within(const PosedMesh& mesh, double reach) const {
        const Point3d& point = tree_.vertices[0];
        bool within = false;
        visit_leaves({tree_, pose_}, mesh, round_up(reach), [&](const MeshNode&, const MeshNode& leaf) {
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count && !within; ++i) {
                const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
                within = triangle_gap({point, point, point}, triangle).distance <= reach;
            }
            return !within;
        });
        return within;
    }

private:
    MeshTree tree_;
    Pose pose_;
};

inline Point3d middle_of(const Triangle3d& triangle) {
    Point3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = triangle[0][axis] / 3 + triangle[1][axis] / 3 + triangle[2][axis] / 3;
    }
    return middle;
}

}  // namespace octopair
