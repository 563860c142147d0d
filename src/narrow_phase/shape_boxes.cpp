// boxes_of(): boxes of shaped objects for the all-pairs stage. The box of a moving object contains its whole sweep.
//
// Meshes    The exact bounds of the vertices in the world.
// Solids    The bounds of the support points, widened by the rounding error.
// Sweeps    The motion is cut into steps of at most 1/8 radian. Between two steps, points stay within Motion::sagitta() of
//           straight lines, so the union of the boxes of all steps is widened by that.
// Planes    The box of a plane perpendicular to an axis (within 1e-9) is as thin as rounding allows. The box of another plane
//           is the bounds of all other objects. A smaller box, around the part of the plane in these bounds, would be wrong for
//           a margin: the point of the plane nearest to an object may lie outside the bounds.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/floating_point_scope.hpp"
#include "geometry/rounding.hpp"
#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/plane_pair.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/error.hpp"

namespace octopair {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

Box3d around(const Point3d& point) { return {{point[0], point[1], point[2]}, {point[0], point[1], point[2]}}; }

void unite(Box3d& box, const Box3d& other) {
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::min(box.min[axis], other.min[axis]);
        box.max[axis] = std::max(box.max[axis], other.max[axis]);
    }
}

void widen(Box3d& box, int axis, double by) {
    box.min[axis] = rounding::next_below(box.min[axis] - by);
    box.max[axis] = rounding::next_above(box.max[axis] + by);
}

Box3d box_by_support(const detail::PreparedShape& shape, const Pose& pose) {
    const Box3d& local = shape.bounds.box;
    Box3d box = shape.vertices.empty() ? Box3d{} : shape.vertices.world_box(pose);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& row = pose.rows[axis];
        const Point3d direction = {row[0], row[1], row[2]};
        if (shape.vertices.empty()) {
            box.max[axis] = vector::dot(direction, support(shape.convex, direction)) + row[3];
            box.min[axis] = vector::dot(direction, support(shape.convex, vector::times(direction, -1))) + row[3];
        }
        double magnitude = std::fabs(row[3]) + shape.convex.radius;
        for (std::size_t k = 0; k < 3; ++k) {
            magnitude += std::fabs(row[k]) * std::max(std::fabs(local.min[k]), std::fabs(local.max[k]));
        }
        // A support errs by a few roundings of each coordinate, and so do three products and four sums.
        widen(box, int(axis), shape.convex.radius + 16 * epsilon * magnitude);
    }
    return box;
}

Box3d box_at(const detail::PreparedShape& shape, const Pose& pose) {
    if (shape.convex.exists()) return box_by_support(shape, pose);
    return shape.vertices.empty() ? around(vector::place(pose)) : shape.vertices.world_box(pose);
}

Box3d swept_box(const detail::PreparedShape& shape, const Motion& motion) {
    Box3d box = box_at(shape, motion.at(0));
    unite(box, box_at(shape, motion.at(1)));
    const int steps = 1 + int(motion.angle() * 8);
    for (int step = 1; step < steps; ++step) unite(box, box_at(shape, motion.at(double(step) / steps)));
    const double reach = vector::length(shape.bounds.centre) + shape.bounds.radius;
    const double sagitta = motion.sagitta(reach, 1.0 / steps);
    for (int axis = 0; axis < 3; ++axis) {
        // Covers the rounding of poses during the motion and of the boxes at these poses.
        const double largest = std::max(std::fabs(box.min[axis]), std::fabs(box.max[axis]));
        widen(box, axis, sagitta + 64 * epsilon * (largest + motion.speed(reach)));
    }
    return box;
}

const shape::Plane* plane_of(const ShapedObjects& objects, std::size_t i) {
    return std::get_if<shape::Plane>(&objects.geometries[objects.geometry[i]].shape());
}

/// Returns the boxes of all objects that are not planes, and extends `bounds` to contain them.
std::vector<Box3d> boxes_of_bounded(const ShapedObjects& objects, std::optional<Box3d>& bounds) {
    check(objects);
    std::vector<Box3d> boxes(objects.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (plane_of(objects, i)) continue;
        const detail::PreparedShape& shape = detail::prepared(objects.geometries[objects.geometry[i]]);
        boxes[i] = objects.end_poses.empty()
                       ? box_at(shape, objects.poses[i])
                       : swept_box(shape, *Motion::between(objects.poses[i], objects.end_poses[i]));
        for (int axis = 0; axis < 3; ++axis) {
            if (std::isfinite(boxes[i].min[axis]) && std::isfinite(boxes[i].max[axis])) continue;
            throw PlacedError(ErrorCode::bad_input,
                              "object " + std::to_string(i) + ": its box is beyond the range of float64",
                              {.index = i, .set = 0, .frame = {}});
        }
        if (!bounds) bounds = boxes[i];
        unite(*bounds, boxes[i]);
    }
    return boxes;
}

/// Returns the axis that the plane is perpendicular to, if there is one.
std::optional<std::size_t> upright_axis(const PosedPlane& plane) {
    // If the normal is tilted by 1e-9, a distance along the axis exceeds the distance along the normal by a relative 1e-18. This is
    // less than a rounding error.
    constexpr double tolerance = 1e-9;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::fabs(plane.normal[(axis + 1) % 3]) > tolerance) continue;
        if (std::fabs(plane.normal[(axis + 2) % 3]) <= tolerance) return axis;
    }
    return std::nullopt;
}

/// Reduces the box along `axis` to the part that contains the plane.
void flatten(Box3d& box, const PosedPlane& plane, std::size_t axis) {
    double slope = 0, reach = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (k == axis) continue;
        slope = std::max(slope, std::fabs(plane.normal[k]));
        reach += std::max(std::fabs(box.min[k] - plane.point[k]), std::fabs(box.max[k] - plane.point[k]));
    }
    box.min[axis] = box.max[axis] = plane.point[axis];
    widen(box, int(axis),
          2 * slope * reach + 16 * epsilon * (std::fabs(plane.point[axis]) + vector::length(plane.point)));
}

void add_planes(const ShapedObjects& objects, const std::optional<Box3d>& bounds, std::vector<Box3d>& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const shape::Plane* shape = plane_of(objects, i);
        if (!shape) continue;
        const PosedPlane plane = posed_plane(*shape, objects.poses[i]);
        if (!bounds) {
            boxes[i] = around(vector::place(objects.poses[i]));
            continue;
        }
        boxes[i] = *bounds;
        const auto axis = upright_axis(plane);
        if (!axis) continue;
        if (objects.end_poses.empty()) {
            flatten(boxes[i], plane, *axis);
            continue;
        }
        // If the normals at the begin and at the end are equal, the object rotates about the normal only. So the normal is constant.
        const PosedPlane end = posed_plane(*shape, objects.end_poses[i]);
        if (upright_axis(end) != axis || (end.normal[*axis] > 0) != (plane.normal[*axis] > 0)) continue;
        flatten(boxes[i], plane, *axis);
        Box3d last = *bounds;
        flatten(last, end, *axis);
        unite(boxes[i], last);
    }
}

}  // namespace

std::vector<Box3d> boxes_of(const ShapedObjects& objects) {
    const FloatingPointScope scope;
    std::optional<Box3d> bounds;
    std::vector<Box3d> boxes = boxes_of_bounded(objects, bounds);
    add_planes(objects, bounds, boxes);
    return boxes;
}

JoinBoxes boxes_of(const ShapedObjects& first, const ShapedObjects& second) {
    const FloatingPointScope scope;
    std::optional<Box3d> bounds;
    JoinBoxes boxes;
    boxes.first = boxes_of_bounded(first, bounds);
    boxes.second = boxes_of_bounded(second, bounds);
    add_planes(first, bounds, boxes.first);
    add_planes(second, bounds, boxes.second);
    return boxes;
}

}  // namespace octopair
