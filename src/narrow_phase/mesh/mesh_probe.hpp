// SurfaceProbe: distances of points from the surface of a posed mesh.
//
// The search starts with the triangle that was nearest to the last point. So queries are cheaper if neighbouring points follow
// one another.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_walk.hpp"
#include "narrow_phase/mesh/world_boxes.hpp"

namespace octopair {

class SurfaceProbe {
public:
    /// Borrows the mesh. Requires: the mesh has triangles.
    explicit SurfaceProbe(const PosedMesh& mesh) : mesh_(mesh), boxes_(mesh) {}

    /// Returns the distance, 0 on the surface. If the distance is at most `enough`, the search ends early and may return any number from
    /// the distance to `enough`.
    double distance(const Point3d& point, double enough) {
        double least = gap(point, nearest_);
        NodeStack<Waiting> waiting;
        waiting.push({0, 0});
        while (least > enough && !waiting.empty()) {
            const Waiting at = waiting.pop();
            if (at.at_least >= least) continue;
            const MeshNode& node = mesh_.tree.nodes[at.node];
            if (node.is_leaf()) {
                test_leaf(node, point, least);
                continue;
            }
            const Waiting first = with_bound(node.first, point), second = with_bound(node.first + 1, point);
            waiting.push(first.at_least <= second.at_least ? second : first);
            waiting.push(first.at_least <= second.at_least ? first : second);
        }
        return least;
    }

private:
    struct Waiting {
        std::uint32_t node;
        double at_least;
    };

    double gap(const Point3d& point, std::uint32_t triangle) const {
        return triangle_gap(point, mesh_.tree.world_triangle(mesh_.pose, triangle));
    }

    void test_leaf(const MeshNode& leaf, const Point3d& point, double& least) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const double found = gap(point, i);
            if (found < least) least = found, nearest_ = i;
        }
    }

    Waiting with_bound(std::uint32_t node, const Point3d& point) const {
        double square = 0, largest = 0;
        for (int row = 0; row < 3; ++row) {
            const auto [low, high] = boxes_.span(mesh_.tree.nodes[node], row);
            const double away = std::max({0.0, low - point[row], point[row] - high});
            square += away * away;
            largest = std::max(largest, away);
        }
        // If the square overflows or underflows, use the largest coordinate instead. The factor covers the rounding of the root.
        const bool fits = square > 0x1p-900 && square < 0x1p900;
        return {node, fits ? std::sqrt(square) * (1 - 0x1p-50) : largest * (1 - 0x1p-50)};
    }

    PosedMesh mesh_;
    WorldBoxes boxes_;
    std::uint32_t nearest_ = 0;
};

inline Point3d middle_of(const Triangle3d& triangle) {
    Point3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = triangle[0][axis] / 3 + triangle[1][axis] / 3 + triangle[2][axis] / 3;
    }
    return middle;
}

}  // namespace octopair
