// set_convex_solid(): whether a mesh is the surface of a convex solid.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/mesh/mesh_tree.hpp"

namespace octopair {

namespace {

/// Returns the corners of all triangles, each place once.
std::vector<Point3d> corners_of(const MeshTree& tree) {
    std::vector<Point3d> corners;
    corners.reserve(tree.triangles.size() * 3);
    for (const auto& triangle : tree.triangles) {
        for (const std::uint32_t corner : triangle) corners.push_back(tree.vertices[corner]);
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
}

/// Returns the largest extent of the corners along an axis.
double extent_of(const std::vector<Point3d>& corners) {
    double extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax_element(
            corners.begin(), corners.end(), [&](const Point3d& a, const Point3d& b) { return a[axis] < b[axis]; });
        extent = std::max(extent, (*high)[axis] - (*low)[axis]);
    }
    return extent;
}

/// Returns the signed volume that a closed mesh encloses, times 6.
double volume_of(const MeshTree& tree) {
    double sum = 0;
    for (const auto& [a, b, c] : tree.triangles) {
        const auto from_first = [&](std::uint32_t i) {
            return vector::minus(tree.vertices[i], tree.vertices[tree.triangles[0][0]]);
        };
        sum += vector::dot(from_first(a), vector::cross(from_first(b), from_first(c)));
    }
    return sum;
}

/// Returns the largest height of a corner above the plane of a triangle; nothing if it exceeds `most`. `sense`: -1 if the triangles face
/// inward, otherwise 1. Ignores triangles that are almost degenerate, because their planes are not reliable.
std::optional<double> height_above(const MeshTree& tree, const std::vector<Point3d>& corners, double sense,
                                   double most) {
    double highest = 0;
    for (const auto& [a, b, c] : tree.triangles) {
        const Point3d &from = tree.vertices[a], &second = tree.vertices[b], &third = tree.vertices[c];
        const PlaneSides plane(from, second, third);
        const Point3d normal = vector::cross(vector::minus(second, from), vector::minus(third, from));
        const double area = vector::length(normal);
        const double longest =
            std::max({vector::length(vector::minus(second, from)), vector::length(vector::minus(third, from)),
                      vector::length(vector::minus(third, second))});
        if (!(area > longest * most)) continue;
        for (const Point3d& corner : corners) {
            if (plane(corner) * sense <= 0) continue;
            const double height = std::fabs(vector::dot(normal, vector::minus(corner, from))) / area;
            if (!(height <= most)) return std::nullopt;
            highest = std::max(highest, height);
        }
    }
    return highest;
}

}  // namespace

void set_convex_solid(MeshTree& tree) {
    constexpr std::size_t max_triangles = 400;
    constexpr double max_error = 0x1p-20;  // relative to the size; covers rounded coordinates and angles in files
    const bool one_part = tree.parts.corners.size() == 1 && tree.parts.sides.front() == MeshParts::Side::oriented;
    if (!one_part || tree.triangles.size() > max_triangles) return;
    std::vector<Point3d> corners = corners_of(tree);
    const double extent = extent_of(corners), volume = volume_of(tree);
    if (!(std::fabs(volume) > max_error * extent * extent * extent)) return;  // flat, or two surfaces that cancel out
    const auto error = height_above(tree, corners, volume > 0 ? 1 : -1, max_error * extent);
    if (!error) return;
    tree.solid = make_convex_solid(shape::ConvexHull{std::move(corners)});
    tree.solid_error = *error;
}

}  // namespace octopair
