// Shapes and poses: what objects are beside their boxes, for the exact stages of the pipeline (pipeline.hpp).
//
// Units     lengths are the caller's own; shapes lie at the origin of their own space, those with an axis along z.
// Closed    a shape is a closed set of points: all but planes and meshes are solid; a mesh that is closed (every edge in
//           an even number of triangles, by position) has an inside as well.
// World     a vertex v of a mesh is in the world where float64 arithmetic puts it, each operation rounded once:
//           ((r0 * v.x + r1 * v.y) + r2 * v.z) + r3 for each row r of the pose. These places are what exact tests judge.
// Ownership a Geometry owns its shape and is shared, cheap to copy and never changes; ShapedObjects borrows.
// Errors    Error{bad_input}, which names the number that is not what it must be, and the object.
// Threads   all of this may be used by many threads at once. CMake: link octopair::pipeline.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

namespace shape {

struct Sphere {
    double radius;  ///< > 0, as all radii
};
struct Box {
    Point3d half_extents;  ///< > 0
};
/// All points within `radius` of the segment from z = -length / 2 to length / 2.
struct Capsule {
    double radius, length;  ///< length >= 0
};
/// From z = -length / 2 to length / 2, as the cone, whose tip is above.
struct Cylinder {
    double radius, length;  ///< > 0
};
struct Cone {
    double radius, length;  ///< > 0
};
struct Ellipsoid {
    Point3d radii;
};
/// The points x with normal * x = offset: a surface without an inside. Planes do not collide with each other.
struct Plane {
    Point3d normal;  ///< of any length but 0
    double offset;
};
/// The convex hull of at least one point.
struct ConvexHull {
    std::vector<Point3d> points;
};
/// Triangles of any kind, degenerate ones too; without any it collides with nothing. Indices are below the number of
/// vertices; those of closed meshes should see them counterclockwise from outside, for contacts' normals.
struct Mesh {
    std::vector<Point3d> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

using Any = std::variant<Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, Plane, ConvexHull, Mesh>;

}  // namespace shape

class Geometry;

namespace detail {  // not for users
struct PreparedShape;
const PreparedShape& prepared(const Geometry& geometry);
}  // namespace detail

/// A shape, made ready to be tested: a mesh with its bounding hierarchy. Objects that look alike share one.
class Geometry {
public:
    explicit Geometry(shape::Any shape);

    const shape::Any& shape() const;

private:
    friend const detail::PreparedShape& detail::prepared(const Geometry& geometry);
    std::shared_ptr<const detail::PreparedShape> prepared_;
};

/// Objects with shapes, borrowed: object i has the geometry geometries[geometry[i]], posed by poses[i].
struct ShapedObjects {
    std::span<const Geometry> geometries;
    std::span<const std::uint32_t> geometry;
    std::span<const Pose> poses;
    /// Empty, or where each object is at time 1: until then it moves straight, and turns evenly about its own origin, the
    /// short way. Planes do not turn.
    std::span<const Pose> end_poses = {};
    std::span<const double> padding = {};  ///< empty, or one clearance per object; finite, >= 0

    std::uint64_t size() const noexcept { return poses.size(); }
};

/// Throws Error unless sizes agree, indices are in range and poses fit their shapes.
void check(const ShapedObjects& objects);

/// For the all-pairs stage: each object's box, without padding, rounded outward; of what it sweeps, if it moves. A plane
/// is cut off where no other object can be: just beyond the boxes of all others, of both sets of a join.
std::vector<Box3d> boxes_of(const ShapedObjects& objects);
struct JoinBoxes {
    std::vector<Box3d> first, second;
};
JoinBoxes boxes_of(const ShapedObjects& first, const ShapedObjects& second);

}  // namespace octopair
