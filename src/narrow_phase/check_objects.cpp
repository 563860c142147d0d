// check(): validates ShapedObjects. Errors name the object.
#include <algorithm>
#include <cmath>
#include <string>

#include "base/floating_point_scope.hpp"
#include "geometry/vector.hpp"
#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"

namespace octopair {
namespace {

[[noreturn]] void refuse_objects(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

void check_sizes(const ShapedObjects& objects) {
    const auto agree = [&](std::size_t size, const std::string& what) {
        if (size == objects.poses.size()) return;
        refuse_objects("there are " + std::to_string(objects.poses.size()) + " poses and " + std::to_string(size) +
                       " " + what);
    };
    agree(objects.geometry.size(), "objects with a geometry");
    if (!objects.end_poses.empty()) agree(objects.end_poses.size(), "end poses");
    if (!objects.padding.empty()) agree(objects.padding.size(), "paddings");
}

/// Returns true if the pose is a rotation and a translation: its columns have length 1 and are perpendicular, and it does not
/// mirror.
bool is_rigid(const Pose& pose) {
    constexpr double tolerance = 1e-6;
    const Point3d x = vector::column(pose, 0), y = vector::column(pose, 1), z = vector::column(pose, 2);
    for (const Point3d& column : {x, y, z}) {
        if (!(std::fabs(vector::length(column) - 1) <= tolerance)) return false;
    }
    for (const double angle : {vector::dot(x, y), vector::dot(y, z), vector::dot(z, x)}) {
        if (!(std::fabs(angle) <= tolerance)) return false;
    }
    return vector::dot(vector::cross(x, y), z) > 0;
}

void check_pose(const Pose& pose, const Geometry& geometry, const std::string& whose) {
    for (const auto& row : pose.rows) {
        for (const double number : row) {
            if (!std::isfinite(number))
                refuse_objects(whose + " has a number that is not finite: " + std::to_string(number));
        }
    }
    const shape::Any& shape = geometry.shape();
    if (std::holds_alternative<shape::Mesh>(shape) || std::holds_alternative<shape::ConvexHull>(shape)) return;
    if (!is_rigid(pose)) {
        refuse_objects(
            whose +
            " scales, shears or mirrors; only poses of meshes and convex hulls may do more than rotate and move");
    }
}

/// Checks that the coordinates of a posed convex shape are so small that sums and differences of a few of them are finite. Does nothing
/// for planes and meshes.
void check_reach(const Pose& pose, const Geometry& geometry, const std::string& whose) {
    constexpr double most = 0x1p1020;
    const detail::PreparedShape& shape = detail::prepared(geometry);
    if (!shape.convex.exists()) return;
    const Box3d& box = shape.bounds.box;
    for (const auto& row : pose.rows) {
        double reach = std::fabs(row[3]);
        for (std::size_t k = 0; k < 3; ++k)
            reach += std::fabs(row[k]) * std::max(std::fabs(box.min[k]), std::fabs(box.max[k]));
        if (!(reach <= most))
            refuse_objects(whose + " brings it beyond 1.1e307, where sums of coordinates are beyond float64");
    }
}

void check_object(const ShapedObjects& objects, std::size_t i) {
    const std::string number = std::to_string(i);
    if (objects.geometry[i] >= objects.geometries.size()) {
        refuse_objects("object " + number + " has geometry " + std::to_string(objects.geometry[i]) + " of " +
                       std::to_string(objects.geometries.size()));
    }
    const Geometry& geometry = objects.geometries[objects.geometry[i]];
    check_pose(objects.poses[i], geometry, "the pose of object " + number);
    check_reach(objects.poses[i], geometry, "the pose of object " + number);
    if (!objects.end_poses.empty()) {
        check_pose(objects.end_poses[i], geometry, "the end pose of object " + number);
        check_reach(objects.end_poses[i], geometry, "the end pose of object " + number);
        const auto motion = Motion::between(objects.poses[i], objects.end_poses[i]);
        if (!motion)
            refuse_objects("object " + number + ": no rotation and translation leads from its pose to its end pose");
        if (motion->angle() > 0 && std::holds_alternative<shape::Plane>(geometry.shape())) {
            refuse_objects("object " + number + " is a plane that rotates; planes may only be moved");
        }
    }
    if (objects.padding.empty()) return;
    const double padding = objects.padding[i];
    if (!(padding >= 0) || !std::isfinite(padding)) {
        refuse_objects("the padding of object " + number + " is " + std::to_string(padding) +
                       "; it must be finite and not below 0");
    }
}

}  // namespace

void check(const ShapedObjects& objects) {
    const FloatingPointScope scope;
    check_sizes(objects);
    for (std::size_t i = 0; i < objects.size(); ++i) {
        try {
            check_object(objects, i);
        } catch (const Error& error) {
            throw PlacedError(error.code(), error.what(), {.index = i, .set = 0, .frame = {}});
        }
    }
}

}  // namespace octopair
