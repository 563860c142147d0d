// WorldBoxes: world boxes of the nodes of a posed mesh's hierarchy, axis by axis, widened by the rounding error.
#pragma once

#include <cmath>

#include "geometry/vector.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"

namespace octopair {

class WorldBoxes {
public:
    /// Borrows the pose. Requires: the mesh has triangles.
    explicit WorldBoxes(const PosedMesh& mesh) : pose_(mesh.pose), origin_(vector::posed(mesh.pose, mesh.tree.origin)) {
        const MeshNode& root = mesh.tree.nodes[0];
        for (int row = 0; row < 3; ++row) {
            double made_of = std::abs(pose_.rows[row][3]);
            for (int axis = 0; axis < 3; ++axis) {
                made_of +=
                    std::abs(pose_.rows[row][axis]) *
                    (std::abs(mesh.tree.origin[axis]) + std::abs(double(root.centre[axis])) + double(root.half[axis]));
            }
            slack_[row] = 64 * 0x1p-53 * made_of;  // fewer than 64 roundings
        }
    }

    /// Interval of a node's box along a world axis; NaN or infinite beyond the range of float32.
    struct Span {
        double low, high;
    };
    Span span(const MeshNode& node, int row) const {
        const auto& r = pose_.rows[row];
        const double centre = origin_[row] + (r[0] * double(node.centre[0]) + r[1] * double(node.centre[1]) +
                                              r[2] * double(node.centre[2]));
        const double half = std::abs(r[0]) * double(node.half[0]) + std::abs(r[1]) * double(node.half[1]) +
                            std::abs(r[2]) * double(node.half[2]) + slack_[row];
        return {centre - half, centre + half};
    }

private:
    const Pose& pose_;
    Point3d origin_, slack_;
};

}  // namespace octopair
