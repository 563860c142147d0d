// Geometry: validates a shape and builds its PreparedShape.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/floating_point_scope.hpp"
#include "geometry/rounding.hpp"
#include "geometry/vector.hpp"
#include "narrow_phase/mesh/mesh_tree.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"

namespace octopair {
namespace {

[[noreturn]] void refuse_geometry(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

void check_length(double value, const std::string& what) {
    if (!(value > 0) || !std::isfinite(value)) {
        refuse_geometry(what + " is " + std::to_string(value) + "; it must be finite and above 0");
    }
    // Subnormal numbers have fewer digits, so pair tests of such objects would not be accurate.
    if (value < std::numeric_limits<double>::min()) {
        refuse_geometry(what + " is below 2.3e-308, the least number of float64 that has all digits");
    }
}

void check_point(const Point3d& point, const std::string& what) {
    for (const double at : point) {
        if (!std::isfinite(at)) refuse_geometry(what + " has a coordinate that is not finite: " + std::to_string(at));
    }
}

void check_lengths(const Point3d& lengths, const std::string& what) {
    for (std::size_t axis = 0; axis < 3; ++axis) check_length(lengths[axis], what + " along " + "xyz"[axis]);
}

void check_shape(const shape::Sphere& sphere) { check_length(sphere.radius, "a sphere's radius"); }
void check_shape(const shape::Box& box) { check_lengths(box.half_extents, "a box's half extent"); }
void check_shape(const shape::Capsule& capsule) {
    check_length(capsule.radius, "a capsule's radius");
    if (!(capsule.length >= 0) || !std::isfinite(capsule.length)) {
        refuse_geometry("a capsule's length is " + std::to_string(capsule.length) +
                        "; it must be finite and not below 0");
    }
}
void check_shape(const shape::Cylinder& cylinder) {
    check_length(cylinder.radius, "a cylinder's radius");
    check_length(cylinder.length, "a cylinder's length");
}
void check_shape(const shape::Cone& cone) {
    check_length(cone.radius, "a cone's radius");
    check_length(cone.length, "a cone's length");
}
void check_shape(const shape::Ellipsoid& ellipsoid) { check_lengths(ellipsoid.radii, "an ellipsoid's radius"); }
void check_shape(const shape::Plane& plane) {
    check_point(plane.normal, "a plane's normal");
    if (plane.normal == Point3d{0, 0, 0}) refuse_geometry("a plane's normal is 0");
    if (!std::isfinite(plane.offset))
        refuse_geometry("a plane's offset is not finite: " + std::to_string(plane.offset));
    const double length = vector::length(plane.normal);
    if (!std::isfinite(length) || !std::isfinite(plane.offset / length)) {
        refuse_geometry("a plane's offset is " + std::to_string(plane.offset) +
                        "; divided by the length of the normal it is beyond float64");
    }
}
void check_shape(const shape::ConvexHull& hull) {
    if (hull.points.empty()) refuse_geometry("a convex hull has no points");
    for (std::size_t i = 0; i < hull.points.size(); ++i) {
        check_point(hull.points[i], "point " + std::to_string(i) + " of a convex hull");
    }
}
void check_shape(const shape::Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        check_point(mesh.vertices[i], "vertex " + std::to_string(i) + " of a mesh");
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (const std::uint32_t vertex : mesh.triangles[i]) {
            if (vertex < mesh.vertices.size()) continue;
            throw PlacedError(ErrorCode::bad_input,
                              "triangle " + std::to_string(i) + " of a mesh has vertex " + std::to_string(vertex) +
                                  " of " + std::to_string(mesh.vertices.size()),
                              {.index = i, .set = 0, .frame = {}});
        }
    }
}

/// Returns the points of a hull, or the vertices of a mesh that some triangle uses; empty for other shapes.
std::vector<Point3d> vertices_of(const shape::Any& shape) {
    if (const auto* hull = std::get_if<shape::ConvexHull>(&shape)) return hull->points;
    const auto* mesh = std::get_if<shape::Mesh>(&shape);
    if (!mesh) return {};
    std::vector<char> used(mesh->vertices.size(), 0);
    for (const auto& triangle : mesh->triangles) {
        for (const std::uint32_t vertex : triangle) used[vertex] = 1;
    }
    std::vector<Point3d> vertices;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i]) vertices.push_back(mesh->vertices[i]);
    }
    return vertices;
}

/// Returns the bounding box: that of the core, widened by the radius and rounded outward.
Box3d box_of(const ConvexSolid& solid) {
    Box3d box = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Point3d direction = {};
        direction[axis] = 1;
        const double high = support(solid, direction)[axis];
        direction[axis] = -1;
        const double low = support(solid, direction)[axis];
        box.max[axis] = solid.radius > 0 ? rounding::next_above(high + solid.radius) : high;
        box.min[axis] = solid.radius > 0 ? rounding::next_below(low - solid.radius) : low;
    }
    return box;
}

double farthest_from(const Point3d& centre, const std::vector<Point3d>& points) {
    double most = 0;
    for (const Point3d& point : points) most = std::max(most, vector::length(vector::minus(point, centre)));
    return most;
}

/// Returns the largest distance of a point of the core from the middle of its box. Requires: the core is not a set of points.
double reach(const ConvexSolid& solid) {
    const Point3d& extents = solid.extents;
    switch (solid.core) {
        case ConvexSolid::Core::ellipsoid:
            return *std::max_element(extents.begin(), extents.end());
        case ConvexSolid::Core::box:
            return vector::length(extents);
        default:
            return std::hypot(extents[0], extents[2]);
    }
}

ShapeBounds bounds_of(const detail::PreparedShape& made, const std::vector<Point3d>& vertices) {
    const ConvexSolid& solid = made.convex;
    if (vertices.empty() && !solid.exists()) return {};
    ShapeBounds bounds;
    bounds.bounded = true;
    bounds.box = vertices.empty() ? box_of(solid) : made.vertices.world_box(Pose{});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bounds.centre[axis] = bounds.box.min[axis] / 2 + bounds.box.max[axis] / 2;
    }
    const bool points = solid.core == ConvexSolid::Core::points;
    const double core =
        points ? farthest_from(bounds.centre, vertices.empty() ? solid.points : vertices) : reach(solid);
    // The factor covers the rounding errors of the radius: of the centre, of differences, of squares and of their sum.
    bounds.radius = (core + solid.radius) * (1 + 16 * std::numeric_limits<double>::epsilon());
    if (!std::isfinite(bounds.radius))
        refuse_geometry("a shape is too large: the radius of its bounding sphere is beyond float64");
    return bounds;
}

}  // namespace

Geometry::Geometry(shape::Any shape) {
    const FloatingPointScope scope;
    std::visit([](const auto& one) { check_shape(one); }, shape);
    auto made = std::make_shared<detail::PreparedShape>();
    made->shape = std::move(shape);
    made->convex = make_convex_solid(made->shape);
    {
        const std::vector<Point3d> vertices = vertices_of(made->shape);
        made->vertices = VertexBlocks(vertices);
        made->bounds = bounds_of(*made, vertices);
    }
    if (const auto* mesh = std::get_if<shape::Mesh>(&made->shape)) {
        made->tree = make_mesh_tree(*mesh);
    } else if (made->convex.exists()) {
        made->tree = std::make_shared<MeshTree>(make_box_tree(made->bounds.box));
    }
    prepared_ = std::move(made);
}

const shape::Any& Geometry::shape() const { return prepared_->shape; }

bool Geometry::closed() const {
    if (!std::holds_alternative<shape::Mesh>(prepared_->shape)) return true;
    return prepared_->tree->parts.all_closed();
}

const detail::PreparedShape& detail::prepared(const Geometry& geometry) { return *geometry.prepared_; }

}  // namespace octopair
