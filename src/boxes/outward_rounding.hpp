// Outward rounding of boxes: moves boxes to an origin, widens them, and rounds them outward to float32, many at once.
#pragma once

#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <span>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "geometry/rounding.hpp"
#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

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

/// Sets boxes[i] to the smallest float32 box that holds triangles[i]. Returns false if any number is not finite.
OCTOPAIR_PRIVATE_EXPORT bool bound_triangles(std::span<const Triangle3d> triangles, std::span<Box3f> boxes);

}  // namespace octopair
