// How far points are from the surface of a posed mesh. The triangle that was nearest to the last point is the first to be
// looked at, so it is well to ask for neighbours one after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "narrow_phase/exact/triangle_gap.hpp"
#include "narrow_phase/mesh/mesh_walk.hpp"
#include "narrow_phase/mesh/world_boxes.hpp"

namespace octopair {

class SurfaceProbe {
public:
    /// Of a mesh with triangles, which is borrowed.
    explicit SurfaceProbe(const PosedMesh& mesh) : mesh_(mesh), boxes_(mesh) {}

    /// The distance, 0 on the surface. Where it is no more than `enough`, any number from it to there: much cheaper.
    double distance(const Point3d& point, double enough) {
        double least = gap(point, nearest_);
        NodeStack<Waiting> waiting;
        waiting.push({0, 0});
        while (least > enough && !waiting.empty()) {
            const Waiting at = waiting.pop();
            if (at.at_least >= least) continue;
            const MeshNode& node = mesh_.tree.nodes[at.node];
            if (node.is_leaf()) {
                look_at(node, point, least);
                continue;
            }
            const Waiting first = weigh(node.first, point), second = weigh(node.first + 1, point);
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

    void look_at(const MeshNode& leaf, const Point3d& point, double& least) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
            const double found = gap(point, i);
            if (found < least) least = found, nearest_ = i;
        }
    }

    Waiting weigh(std::uint32_t node, const Point3d& point) const {
        double square = 0, largest = 0;
        for (int row = 0; row < 3; ++row) {
            const auto [low, high] = boxes_.span(mesh_.tree.nodes[node], row);
            const double away = std::max({0.0, low - point[row], point[row] - high});
            square += away * away;
            largest = std::max(largest, away);
        }
        // Squares that are beyond float64 tell nothing, and roots are rounded.
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
