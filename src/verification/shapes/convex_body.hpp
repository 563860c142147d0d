// ConvexBody: a convex set in the world, given by its support function, in extended precision (long double).
//
// The code shares nothing with the narrow phase but the public description of shapes (octopair/shapes.hpp).
#pragma once

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair::certificate {

using Real = long double;

struct Vector {
    Real x = 0, y = 0, z = 0;

    Vector operator+(const Vector& other) const { return {x + other.x, y + other.y, z + other.z}; }
    Vector operator-(const Vector& other) const { return {x - other.x, y - other.y, z - other.z}; }
    Vector operator-() const { return {-x, -y, -z}; }
    Vector operator*(Real factor) const { return {x * factor, y * factor, z * factor}; }
};
inline Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real length(const Vector& a) { return std::hypot(a.x, a.y, a.z); }
inline Vector vector_of(const Point3d& point) { return {point[0], point[1], point[2]}; }

/// Returns the point to which a pose moves a vertex of a mesh: in float64, rounded as octopair/shapes.hpp says.
Vector moved_vertex(const Pose& pose, const Point3d& vertex);

class ConvexBody {
public:
    /// Requires: `shape` is neither a plane nor a mesh. Borrows the points of a convex hull.
    ConvexBody(const shape::Any& shape, const Pose& pose) : shape_(&shape), pose_(pose) {}
    /// Makes the convex hull of points in the world, for example of a triangle. Requires: at least one point.
    explicit ConvexBody(std::vector<Vector> points) : points_(std::move(points)) {}

    /// Returns a point of the body that is farthest along `direction`. `direction` has any length but 0.
    Vector support(const Vector& direction) const;
    /// Returns the largest coordinate of the body along a direction.
    Real reach(const Vector& direction) const { return dot(support(direction), direction); }
    /// Returns the body, moved.
    ConvexBody moved(const Vector& by) const;
    /// Returns half the longest side of the box around the body: a measure of its size.
    Real radius() const;
    /// Returns the largest absolute value of a coordinate of the body.
    Real largest_coordinate() const;

private:
    const shape::Any* shape_ = nullptr;  // null: the hull of points_
    Pose pose_;
    std::vector<Vector> points_;
    Vector offset_;
};

}  // namespace octopair::certificate
