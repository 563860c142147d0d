#include "narrow_phase/convex/convex_solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/vector.hpp"

namespace octopair {
namespace {

using Core = ConvexSolid::Core;

ConvexSolid of_points(std::vector<Point3d> points, double radius) {
    ConvexSolid solid;
    for (const Point3d& point : points) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            solid.largest[axis] = std::max(solid.largest[axis], std::fabs(point[axis]));
        }
    }
    solid.points = std::move(points);
    solid.radius = radius;
    return solid;
}

ConvexSolid within(Core core, const Point3d& extents) { return {core, extents, {}, 0, extents}; }

ConvexSolid solid_of(const shape::Sphere& sphere) { return of_points({{0, 0, 0}}, sphere.radius); }
ConvexSolid solid_of(const shape::Box& box) { return within(Core::box, box.half_extents); }
ConvexSolid solid_of(const shape::Capsule& capsule) {
    return of_points({{0, 0, -capsule.length / 2}, {0, 0, capsule.length / 2}}, capsule.radius);
}
ConvexSolid solid_of(const shape::Cylinder& cylinder) {
    return within(Core::cylinder, {cylinder.radius, cylinder.radius, cylinder.length / 2});
}
ConvexSolid solid_of(const shape::Cone& cone) {
    return within(Core::cone, {cone.radius, cone.radius, cone.length / 2});
}
ConvexSolid solid_of(const shape::Ellipsoid& ellipsoid) { return within(Core::ellipsoid, ellipsoid.radii); }
ConvexSolid solid_of(const shape::ConvexHull& hull) { return of_points(hull.points, 0); }
ConvexSolid solid_of(const shape::Plane&) { return {}; }
ConvexSolid solid_of(const shape::Mesh&) { return {}; }

Point3d farthest(const std::vector<Point3d>& points, const Point3d& direction) {
    return *std::max_element(points.begin(), points.end(), [&](const Point3d& a, const Point3d& b) {
        return vector::dot(a, direction) < vector::dot(b, direction);
    });
}

/// Returns the support point of a disk around the z axis, with the given radius, at z = `height`.
Point3d rim(double radius, double height, const Point3d& direction) {
    const double across = std::hypot(direction[0], direction[1]);
    if (across == 0) return {radius, 0, height};
    return {radius * (direction[0] / across), radius * (direction[1] / across), height};
}

Point3d of_ellipsoid(const Point3d& radii, const Point3d& direction) {
    const Point3d scaled = {radii[0] * direction[0], radii[1] * direction[1], radii[2] * direction[2]};
    const double length = vector::length(scaled);
    if (length == 0) return {radii[0], 0, 0};
    return {radii[0] * (scaled[0] / length), radii[1] * (scaled[1] / length), radii[2] * (scaled[2] / length)};
}

}  // namespace

ConvexSolid make_convex_solid(const shape::Any& shape) {
    return std::visit([](const auto& one) { return solid_of(one); }, shape);
}

Point3d support(const ConvexSolid& solid, const Point3d& direction) {
    const Point3d& extents = solid.extents;
    switch (solid.core) {
        case Core::points:
            return farthest(solid.points, direction);
        case Core::box:
            return {std::copysign(extents[0], direction[0]), std::copysign(extents[1], direction[1]),
                    std::copysign(extents[2], direction[2])};
        case Core::cylinder:
            return rim(extents[0], std::copysign(extents[2], direction[2]), direction);
        case Core::ellipsoid:
            return of_ellipsoid(extents, direction);
        case Core::cone:
            break;
    }
    const Point3d tip = {0, 0, extents[2]}, base = rim(extents[0], -extents[2], direction);
    return vector::dot(base, direction) > vector::dot(tip, direction) ? base : tip;
}

}  // namespace octopair
