// Checks of input boxes, and functions that copy boxes or round them outward, many at once.
#pragma once

#include <array>
#include <cfloat>
#include <cmath>
#include <span>

#include "base/private_export.hpp"
#include "boxes/box_check.hpp"
#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "geometry/rounding.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

template <typename Real>
Box3d wide(const Box<Real>& box) {
    return {{double(box.min[0]), double(box.min[1]), double(box.min[2])},
            {double(box.max[0]), double(box.max[1]), double(box.max[2])}};
}

/// True if the closed boxes overlap.
template <typename Real>
bool overlap(const Box<Real>& a, const Box<Real>& b) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) all &= a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis];
    return all;
}

/// Moves boxes to an origin, widens them, and rounds them outward to float32.
struct OutwardRounding {
    /// Relative error that is added to widened boxes: this part of the bound, of the origin and of the widening.
    /// Without widening, subtraction and rounding are monotone and lose no pair. With widening, the roundings here and in the
    /// pair rule (octopair/objects.hpp) must be covered. Each is below 2^-52 of a number that is at most the sum of the three.
    static constexpr double error_part = 0x1p-48;
    /// The sum of two larger widenings may overflow in the pair rule, which then holds for any gap.
    static constexpr double max_widening = DBL_MAX / 4;

    std::array<double, 4> origin = {0, 0, 0, 0};
    double margin = 0;

    /// Specification of round_boxes() for one box. Sets only the bounds of the entry.
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
        if (widening > max_widening) return FLT_MAX;
        // Each part is multiplied separately: the sum may overflow float64.
        const double error = std::abs(bound) * error_part + std::abs(origin[axis]) * error_part + widening * error_part;
        const double extra = widening > 0 ? widening + error : 0;
        return rounding::finite_float_above(sign * (bound - origin[axis]) + extra);
    }
};

/// True if all boxes are valid (is_box()).
bool are_boxes(std::span<const Box3f> boxes);
bool are_boxes(std::span<const Box3d> boxes);

/// Copies the bounds of boxes unchanged. Returns false if is_box() is false for any box.
bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out);

/// Rounds boxes outward and sets the bounds of `out`; `object` and `mask` of entries are then unspecified. Returns false if is_box() or
/// is_padding() is false for any box. `padding`: one number for each box, or empty for none.
bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out);
bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Entry> out);
bool round_boxes(std::span<const Box3f> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Box3f> out);
bool round_boxes(std::span<const Box3d> boxes, std::span<const double> padding, const OutwardRounding& rounding,
                 std::span<Box3f> out);

/// The boxes of the objects `a` and `b` of pairs. The first object `b` has the number `second_begin`.
template <typename Real>
struct BoxesOfPairs {
    const Box<Real>* first;
    const Box<Real>* second;
    std::uint32_t second_begin;

    const Box<Real>& a(const Pair& pair) const { return first[pair.a]; }
    const Box<Real>& b(const Pair& pair) const { return second[pair.b - second_begin]; }
};

/// Implements EntrySource::refused() for boxes that are a pair if they overlap.
std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out);
std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<double>& boxes, std::uint32_t* out);

/// Sets boxes[i] to the smallest float32 box that holds triangles[i]. Returns false if any number is not finite.
OCTOPAIR_PRIVATE_EXPORT bool bound_triangles(std::span<const Triangle3d> triangles, std::span<Box3f> boxes);

}  // namespace octopair
