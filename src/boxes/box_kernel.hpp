// What is done to every box on its way in: it is checked, and copied or rounded outward.
#pragma once

#include <array>
#include <cfloat>
#include <cmath>
#include <limits>
#include <span>

#include "boxes/entry.hpp"
#include "geometry/rounding.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// min <= max on every axis, and all finite.
template <typename Real>
bool is_box(const Box<Real>& box) {
    bool good = true;
    for (int axis = 0; axis < 3; ++axis) {
        // Also false for NaN; |finite| <= max is false for the infinities.
        good &= box.min[axis] <= box.max[axis];
        good &= std::abs(box.min[axis]) <= std::numeric_limits<Real>::max();
        good &= std::abs(box.max[axis]) <= std::numeric_limits<Real>::max();
    }
    return good;
}

template <typename Real>
Box3d wide(const Box<Real>& box) {
    return {{double(box.min[0]), double(box.min[1]), double(box.min[2])},
            {double(box.max[0]), double(box.max[1]), double(box.max[2])}};
}

inline bool is_padding(double value) { return value >= 0 && value <= DBL_MAX; }

/// Boxes are moved to an origin, widened, and rounded outward to float32.
struct OutwardRounding {
    /// Parts of the numbers that are added where boxes are widened. Without widening, subtraction and rounding are
    /// monotone and lose no pair. With it, the rule's own roundings (objects.hpp) and those here must be covered: each
    /// is below 2^-52 of a number no larger than the sum of these.
    static constexpr double error_part = 0x1p-48;
    /// Two widenings above this may overflow in the rule, which then holds for any gap.
    static constexpr double most_widening = DBL_MAX / 4;

    std::array<double, 4> origin = {0, 0, 0, 0};
    double margin = 0;

    /// The specification of round_boxes; only the bounds are set.
    Entry entry(const Box3d& box, double padding) const {
        const double widening = margin / 2 + padding;
        Entry entry{};
        for (unsigned axis = 0; axis < 3; ++axis) {
            entry.min[axis] = -outward(-1, box.min[axis], axis, widening);
            entry.max[axis] = outward(1, box.max[axis], axis, widening);
        }
        return entry;
    }

private:
    float outward(double sign, double bound, unsigned axis, double widening) const {
        if (widening > most_widening) return FLT_MAX;
        // Each part on its own: their sum may be beyond float64.
        const double error = std::abs(bound) * error_part + std::abs(origin[axis]) * error_part + widening * error_part;
        const double extra = widening > 0 ? widening + error : 0;
        return rounding::finite_float_above(sign * (bound - origin[axis]) + extra);
    }
};

/// Whether is_box() is true of all.
bool are_boxes(std::span<const Box3f> boxes);
bool are_boxes(std::span<const Box3d> boxes);

/// Copies the bounds of boxes as they are; false if is_box() is not true of all.
bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out);

/// Rounds boxes outward, whose paddings are `padding` or, if that is empty, 0; false if is_box() or is_padding() is not
/// true of all. Sets the bounds; what else is in the entries is lost.
bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out);
bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out);

/// Boxes of as many triangles: the smallest of float32 that hold them. False if not all are finite.
bool bound_triangles(std::span<const Triangle3d> triangles, std::span<Box3f> boxes);

}  // namespace octopair
