#include "verification/shapes/convex_body.hpp"

#include <algorithm>
#include <variant>

namespace octopair::certificate {

namespace {

/// Returns `direction` with length 1, or 0 if it is 0.
Vector unit(const Vector& direction) {
    const Real size = length(direction);
    return size > 0 ? direction * (1 / size) : Vector();
}

Real with_sign(Real size, Real sign) { return sign < 0 ? -size : size; }

/// Returns the point of the circle of this radius around the z axis that is farthest along `direction`, with z = 0.
Vector on_circle(Real radius, const Vector& direction) { return unit({direction.x, direction.y, 0}) * radius; }

// Each returns a point of a shape in its local space that is farthest along a direction.

Vector farthest(const shape::Sphere& sphere, const Vector& direction) { return unit(direction) * sphere.radius; }
Vector farthest(const shape::Box& box, const Vector& direction) {
    return {with_sign(box.half_extents[0], direction.x), with_sign(box.half_extents[1], direction.y),
            with_sign(box.half_extents[2], direction.z)};
}
Vector farthest(const shape::Capsule& capsule, const Vector& direction) {
    return unit(direction) * capsule.radius + Vector{0, 0, with_sign(Real(capsule.length) / 2, direction.z)};
}
Vector farthest(const shape::Cylinder& cylinder, const Vector& direction) {
    return on_circle(cylinder.radius, direction) + Vector{0, 0, with_sign(Real(cylinder.length) / 2, direction.z)};
}
Vector farthest(const shape::Cone& cone, const Vector& direction) {
    const Vector tip{0, 0, Real(cone.length) / 2}, base = on_circle(cone.radius, direction) - tip;
    return dot(tip, direction) >= dot(base, direction) ? tip : base;
}
Vector farthest(const shape::Ellipsoid& ellipsoid, const Vector& direction) {
    const Vector radii = vector_of(ellipsoid.radii);
    const Vector stretched = unit({radii.x * direction.x, radii.y * direction.y, radii.z * direction.z});
    return {radii.x * stretched.x, radii.y * stretched.y, radii.z * stretched.z};
}
template <typename Points, typename ToVector>
Vector farthest_of(const Points& points, const Vector& direction, ToVector&& to_vector) {
    Vector best = to_vector(points.front());
    for (const auto& point : points) {
        const Vector candidate = to_vector(point);
        if (dot(candidate, direction) > dot(best, direction)) best = candidate;
    }
    return best;
}
Vector farthest(const shape::ConvexHull& hull, const Vector& direction) {
    return farthest_of(hull.points, direction, vector_of);
}
Vector farthest(const shape::Plane&, const Vector&) { return {}; }
Vector farthest(const shape::Mesh&, const Vector&) { return {}; }

}  // namespace

Vector moved_vertex(const Pose& pose, const Point3d& vertex) {
    std::array<double, 3> moved{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& row = pose.rows[i];
        moved[i] = ((row[0] * vertex[0] + row[1] * vertex[1]) + row[2] * vertex[2]) + row[3];
    }
    return vector_of(moved);
}

Vector ConvexBody::support(const Vector& direction) const {
    if (shape_ == nullptr) return farthest_of(points_, direction, [](const Vector& point) { return point; }) + offset_;
    const auto& rows = pose_.rows;
    const auto column = [&](std::size_t i) { return Vector{rows[0][i], rows[1][i], rows[2][i]}; };
    const Vector local{dot(column(0), direction), dot(column(1), direction), dot(column(2), direction)};
    const Vector point = std::visit([&](const auto& shape) { return farthest(shape, local); }, *shape_);
    return column(0) * point.x + column(1) * point.y + column(2) * point.z + column(3) + offset_;
}

ConvexBody ConvexBody::moved(const Vector& by) const {
    ConvexBody body = *this;
    body.offset_ = body.offset_ + by;
    return body;
}

Real ConvexBody::radius() const {
    Real largest = 0;
    for (const Vector& axis : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}})
        largest = std::max(largest, reach(axis) + reach(-axis));
    return largest / 2;
}

Real ConvexBody::largest_coordinate() const {
    Real largest = 0;
    for (const Vector& axis : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}})
        largest = std::max({largest, std::abs(reach(axis)), std::abs(reach(-axis))});
    return largest;
}

}  // namespace octopair::certificate
