// Bounding boxes of FCL's collision objects.
//
// Invariants
//   A tight box contains the local box of the geometry (CollisionGeometry::aabb_local) under the object's transform, in exact
//   arithmetic. Sums that are not exact are rounded outward.
//   The coordinates of a box are finite. Infinite ones become the largest finite number of their sign.
#pragma once

#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "octopair/error.hpp"
#include "octopair/objects.hpp"

namespace octopair::fcl {

/// Kind of bounding box that stands for an object.
enum class BoundingBoxes : std::uint8_t {
    tight,  ///< the rotated local box, computed from the object's present transform
    fcl,  ///< CollisionObject::getAABB(), the box of the last computeAABB(); for rotated objects, the cube around a sphere
};

namespace detail {

/// Returns `a + b`, or the next number below if rounding raised the sum.
template <typename S>
S sum_below(S a, S b) {
    const S sum = a + b, b_part = sum - a;
    const S error = (a - (sum - b_part)) + (b - b_part);  // exact: sum + error == a + b
    return error < 0 ? std::nextafter(sum, -std::numeric_limits<S>::infinity()) : sum;
}

/// Returns the local box under a transform without rotation.
template <typename S>
Box<S> moved_box(const ::fcl::AABB<S>& local, const ::fcl::Vector3<S>& translation) {
    Box<S> box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = sum_below(local.min_[axis], translation[axis]);
        box.max[axis] = -sum_below(-local.max_[axis], -translation[axis]);
    }
    return box;
}

/// Returns the box around the local box under a transform.
template <typename S>
Box<S> rotated_box(const ::fcl::AABB<S>& local, const ::fcl::Transform3<S>& transform) {
    // The centre, the half extent and their sum have a relative error below 8 epsilon of the sum of the absolute values of their
    // terms. Numbers that underflow lose less than `min()`.
    constexpr S rounding = 8 * std::numeric_limits<S>::epsilon();
    constexpr S largest = std::numeric_limits<S>::max();
    S centre[3], extent[3];
    for (int axis = 0; axis < 3; ++axis) {
        const S lower = std::max(local.min_[axis], -largest) / 2, upper = std::min(local.max_[axis], largest) / 2;
        centre[axis] = upper + lower;
        extent[axis] = upper - lower;
    }
    const S* const columns = transform.data();  // 4 x 4, column after column
    Box<S> box;
    for (int axis = 0; axis < 3; ++axis) {
        S middle = columns[12 + axis], size = std::abs(middle), reach = 0;
        for (int from = 0; from < 3; ++from) {
            const S factor = columns[4 * from + axis], term = factor * centre[from];
            middle += term;
            size += std::abs(term);
            reach += std::abs(factor) * extent[from];
        }
        reach += rounding * (size + reach) + std::numeric_limits<S>::min();
        box.min[axis] = middle - reach;
        box.max[axis] = middle + reach;
    }
    return box;
}

/// Returns whether the transform has no rotation. FCL's own test accepts small rotations.
template <typename S>
bool is_translation(const ::fcl::Transform3<S>& transform) {
    const S* const m = transform.data();
    return m[0] == 1 && m[5] == 1 && m[10] == 1 && m[1] == 0 && m[2] == 0 && m[4] == 0 && m[6] == 0 && m[8] == 0 &&
           m[9] == 0;
}

template <typename S>
Box<S> to_box(const ::fcl::AABB<S>& aabb) {
    Box<S> box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = aabb.min_[axis];
        box.max[axis] = aabb.max_[axis];
    }
    return box;
}

/// Returns the box of an object, which may be invalid.
template <typename S>
Box<S> bounding_box(const ::fcl::CollisionObject<S>& object, const ::fcl::CollisionGeometry<S>& geometry,
                    BoundingBoxes kind) {
    if (kind == BoundingBoxes::fcl) return to_box(object.getAABB());
    const ::fcl::Transform3<S>& transform = object.getTransform();
    if (is_translation(transform)) return moved_box<S>(geometry.aabb_local, transform.translation());
    return rotated_box(geometry.aabb_local, transform);
}

/// Returns whether the box is valid: finite, with min <= max.
template <typename S>
bool is_valid(const Box<S>& box) {
    constexpr S largest = std::numeric_limits<S>::max();
    bool result = true;
    for (int axis = 0; axis < 3; ++axis) {
        result &= (box.min[axis] <= box.max[axis]) & (box.min[axis] >= -largest) & (box.max[axis] <= largest);
    }
    return result;
}

/// Makes a box valid: replaces infinite coordinates by the largest finite ones. Returns false if the box is not a number, or empty.
template <typename S>
bool make_valid(Box<S>& box) {
    if (is_valid(box)) return true;
    constexpr S largest = std::numeric_limits<S>::max();
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.min[axis] <= box.max[axis])) return false;
        box.min[axis] = std::clamp(box.min[axis], -largest, largest);
        box.max[axis] = std::clamp(box.max[axis], -largest, largest);
    }
    return true;
}

/// Throws Error{bad_input} that says what is wrong with a box. `object` names its object.
template <typename S>
[[noreturn]] void refuse_box(const Box<S>& box, const std::string& object) {
    int axis = 0;
    while (axis < 2 && box.min[axis] <= box.max[axis]) ++axis;
    const std::string name(1, "xyz"[axis]);
    const auto number = [](S value) { return " (" + std::to_string(value) + ")"; };
    const bool is_nan = std::isnan(box.min[axis]) || std::isnan(box.max[axis]);
    const std::string relation = is_nan ? " or max." : " is greater than max.";
    throw Error(ErrorCode::bad_input, "octopair::fcl: bounding box of " + object + ": min." + name +
                                          number(box.min[axis]) + relation + name + number(box.max[axis]) +
                                          (is_nan ? " is not a number" : ""));
}

/// Returns the box of an object that a call passes. Throws: Error{bad_input} if the box is invalid.
template <typename S>
Box<S> box_of_argument(const ::fcl::CollisionObject<S>& object, BoundingBoxes kind) {
    Box<S> box = bounding_box(object, *object.collisionGeometry(), kind);
    if (!make_valid(box)) refuse_box(box, "an object of the call");
    return box;
}

/// Returns a box in float64.
template <typename S>
Box3d to_double(const Box<S>& box) {
    return {{double(box.min[0]), double(box.min[1]), double(box.min[2])},
            {double(box.max[0]), double(box.max[1]), double(box.max[2])}};
}

}  // namespace detail

}  // namespace octopair::fcl
