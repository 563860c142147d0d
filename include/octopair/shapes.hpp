// Shapes: the exact geometry of objects, for the exact stages of the pipeline (pipeline.hpp).
//
// Units     Lengths are in the caller's unit. A shape is centred at the origin of its local space; an axis is the z axis.
// Closed    A shape is a closed set of points. All shapes but planes and meshes are solid. A closed mesh (every edge in an even
//           number of triangles, by position) also has an interior.
// World     Each row r of the pose gives a world coordinate of a mesh vertex v: ((r0 * v.x + r1 * v.y) + r2 * v.z) + r3, each
//           operation rounded once in float64. The exact tests use these positions.
// Ownership A Geometry owns its shape, never changes, and is cheap to copy: copies share the shape. ShapedObjects borrows.
// Errors    Error{bad_input}, which names the invalid number and the object.
// Threads   Any number of threads may use all of this at once. CMake: link octopair::pipeline.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace [[gnu::visibility("default")]] octopair {

namespace shape {

struct Sphere {
    double radius;  ///< > 0, like all radii
};
struct Box {
    Point3d half_extents;  ///< > 0
};
/// All points within `radius` of the segment from z = -length / 2 to length / 2.
struct Capsule {
    double radius, length;  ///< length >= 0
};
/// Extends from z = -length / 2 to length / 2.
struct Cylinder {
    double radius, length;  ///< > 0
};
/// Extends from z = -length / 2, its base, to z = length / 2, its tip.
struct Cone {
    double radius, length;  ///< > 0
};
struct Ellipsoid {
    Point3d radii;
};
/// The points x with normal * x = offset: a surface without an interior. Planes do not collide with each other.
struct Plane {
    Point3d normal;  ///< any length but 0
    double offset;
};
/// The convex hull of at least one point.
struct ConvexHull {
    std::vector<Point3d> points;
};
/// A triangle mesh; triangles may be degenerate. A mesh without triangles collides with nothing. Each index is below the number
/// of vertices. Triangles of a closed mesh should be counterclockwise seen from outside, so that contact normals are right.
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

/// Closes small gaps. First makes vertices in equal places one. Then joins vertices at the borders of gaps that are at most `tolerance`
/// apart; an edge in an odd number of triangles is such a border. Joins can form chains: all vertices of a chain move to the place of
/// the first vertex. Other vertices and closed meshes keep their shape. Triangles keep their numbers; some may become degenerate.
/// Throws: Error{bad_input} if the tolerance is negative or not finite.
void weld(shape::Mesh& mesh, double tolerance);

/// A shape that is prepared for tests. For a mesh, this includes a bounding volume hierarchy. Objects of equal shape should share one.
class Geometry {
public:
    /// Checks and prepares `shape`. Throws: Error{bad_input} if it is invalid.
    explicit Geometry(shape::Any shape);

    const shape::Any& shape() const;
    /// Returns false if a part of a mesh is not closed: an edge is in an odd number of triangles. Such a part has no inside, so an
    /// object within the part does not meet the mesh. Always true for other shapes.
    bool closed() const;

private:
    friend const detail::PreparedShape& detail::prepared(const Geometry& geometry);
    std::shared_ptr<const detail::PreparedShape> prepared_;
};

/// Objects with shapes, borrowed. Object i has the geometry geometries[geometry[i]] and the pose poses[i].
struct ShapedObjects {
    std::span<const Geometry> geometries;
    std::span<const std::uint32_t> geometry;
    std::span<const Pose> poses;
    /// Pose of each object at time 1; empty: no object moves. From time 0 to 1 the origin of an object moves in a straight
    /// line. The object turns about its origin at constant speed, by the smaller angle. Planes do not turn.
    std::span<const Pose> end_poses = {};
    std::span<const double> padding = {};  ///< clearance of each object, finite and >= 0; empty: none

    std::uint64_t size() const noexcept { return poses.size(); }
};

/// Checks that sizes are equal, indices are in range and poses suit their shapes. Throws: Error{bad_input} if not.
void check(const ShapedObjects& objects);

/// Returns the box of each object for the all-pairs stage: without padding, rounded outward. The box of a moving object
/// contains its whole motion. A plane's box ends just beyond the boxes of all other objects, in a join of both sets.
std::vector<Box3d> boxes_of(const ShapedObjects& objects);
struct JoinBoxes {
    std::vector<Box3d> first, second;
};
JoinBoxes boxes_of(const ShapedObjects& first, const ShapedObjects& second);

}  // namespace octopair
