#include "narrow_phase/thickness/outer_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "geometry/vector.hpp"

namespace octopair {

namespace {

constexpr double pi = std::numbers::pi;

/// Returns the number of sides of a regular polygon around a circle that is at most `error` outside of it: a multiple of 4, not above 48.
std::uint32_t sides_around(double radius, double error) {
    const double sides = pi / std::acos(radius / (radius + error));
    return 4 * std::clamp<std::uint32_t>(std::uint32_t(std::ceil(std::min(sides, 48.0) / 4)), 2, 12);
}

/// Radius and z of a point of a profile.
using ProfilePoint = std::array<double, 2>;

/// Returns the solid that a profile makes around the z axis, with `sides` sides. The profile goes from the top of the axis to its bottom;
/// its first and last points are on the axis. The sides touch the circles of the profile's points from outside.
shape::Mesh revolved(const std::vector<ProfilePoint>& profile, std::uint32_t sides) {
    shape::Mesh mesh;
    const double outward = 1 / std::cos(pi / sides);
    const auto rings = std::uint32_t(profile.size() - 2);
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        for (std::uint32_t side = 0; side < sides; ++side) {
            const double angle = 2 * pi * side / sides, radius = profile[ring][0] * outward;
            mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), profile[ring][1]});
        }
    }
    const auto top = std::uint32_t(mesh.vertices.size());
    mesh.vertices.push_back({0, 0, profile.front()[1]});
    mesh.vertices.push_back({0, 0, profile.back()[1]});
    const auto vertex = [&](std::uint32_t ring, std::uint32_t side) { return ring * sides + side % sides; };
    for (std::uint32_t side = 0; side < sides; ++side) {
        mesh.triangles.push_back({top, vertex(0, side), vertex(0, side + 1)});
        mesh.triangles.push_back({top + 1, vertex(rings - 1, side + 1), vertex(rings - 1, side)});
        for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
            const std::uint32_t above = vertex(ring, side), next = vertex(ring, side + 1);
            const std::uint32_t below = vertex(ring + 1, side), last = vertex(ring + 1, side + 1);
            mesh.triangles.push_back({above, below, last});
            mesh.triangles.push_back({above, last, next});
        }
    }
    return mesh;
}

/// Returns a mesh around all points within `radius` of the segment from z = -half to z = half.
OuterMesh around_capsule(double radius, double half, double error) {
    const std::uint32_t sides = sides_around(radius, error / 2), arcs = sides / 2;
    const double outward = 1 / std::cos(pi / (2 * arcs));
    std::vector<ProfilePoint> profile = {{0, radius + half}};
    for (std::uint32_t i = 0; i < arcs; ++i) {
        const double angle = (i + 0.5) * pi / arcs, shift = i < arcs / 2 ? half : -half;
        profile.push_back({radius * outward * std::sin(angle), radius * outward * std::cos(angle) + shift});
    }
    profile.push_back({0, -radius - half});
    return {revolved(profile, sides), radius * (outward / std::cos(pi / sides) - 1)};
}

OuterMesh around_ellipsoid(const Point3d& radii, double error) {
    const double largest = std::max({radii[0], radii[1], radii[2]});
    OuterMesh outer = around_capsule(1, 0, error / largest);
    for (Point3d& vertex : outer.mesh.vertices) {
        for (std::size_t axis = 0; axis < 3; ++axis) vertex[axis] *= radii[axis];
    }
    outer.error *= largest;
    return outer;
}

/// Returns a mesh around a cylinder or a cone.
OuterMesh around_disks(const ConvexSolid& solid, double error) {
    const double radius = solid.extents[0], half = solid.extents[2];
    const std::uint32_t sides = sides_around(radius, error);
    std::vector<ProfilePoint> profile = {{0, half}, {radius, -half}, {0, -half}};
    if (solid.core == ConvexSolid::Core::cylinder) profile.insert(profile.begin() + 1, {radius, half});
    return {revolved(profile, sides), radius * (1 / std::cos(pi / sides) - 1)};
}

OuterMesh mesh_of_box(const Point3d& half) {
    OuterMesh outer;
    for (unsigned i = 0; i < 8; ++i) {
        Point3d& corner = outer.mesh.vertices.emplace_back(half);
        for (unsigned axis = 0; axis < 3; ++axis) {
            if ((i >> axis & 1U) == 0) corner[axis] = -corner[axis];
        }
    }
    outer.mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                            {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    return outer;
}

}  // namespace

std::optional<OuterMesh> make_outer_mesh(const ConvexSolid& solid, double error) {
    using Core = ConvexSolid::Core;
    switch (solid.core) {
        case Core::box:
            return mesh_of_box(solid.extents);
        case Core::cylinder:
        case Core::cone:
            return around_disks(solid, error);
        case Core::ellipsoid:
            return around_ellipsoid(solid.extents, error);
        case Core::points:
            break;
    }
    // A sphere or a capsule; a hull has no radius.
    if (!(solid.radius > 0)) return std::nullopt;
    return around_capsule(solid.radius, solid.points.back()[2], error);
}

}  // namespace octopair
