// Signs that are exact for all finite float64 coordinates. line_side(): the side of a line in a projection. compare_square_sums(): the
// order of two sums of squared differences; this function is slow, and is for cases that float64 rounding leaves open.
//
// Filter    A sign is first computed in float64. Each operation errs by at most 2^-53 of its result. So the sum errs by at
//           most a small multiple of 2^-53 of the permanent, which is the sum with absolute values of all terms.
// Underflow A term that underflows errs by less than the smallest number times a factor; filter::underflow is far larger than this error.
// Overflow  An overflow makes the permanent infinite or NaN, so the sign counts as undecided.
// Exact     A sum beyond the error bound has the right sign. Otherwise the sign is computed again, with integers.
// Source    Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997, section 4.
#pragma once

#include <array>
#include <cmath>

#include "base/private_export.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Returns the sign of line_side(), -1, 0 or 1, computed with integers. Slow.
OCTOPAIR_PRIVATE_EXPORT int exact_line_side(const Point3d& a, const Point3d& b, const Point3d& c, unsigned axis);

namespace filter {

inline constexpr double line_error = 0x1p-51;  ///< above (3 + 16 * 2^-53) * 2^-53
inline constexpr double underflow = 0x1p-900;  ///< far above the loss of all terms that underflow below 2^-1022

/// Returns the sign of `sum` if its absolute value is larger than `error`; otherwise 0: float64 cannot decide the sign.
inline int safe_sign(double sum, double error) { return int(sum > error) - int(sum < -error); }

}  // namespace filter

/// Returns the sign of coordinate `axis` of (b - a) x (c - a): the side of the line from a to b on which c lies, projected
/// along `axis`, which points to the viewer. 1: left, -1: right, 0: on the line.
inline int line_side(const Point3d& a, const Point3d& b, const Point3d& c, unsigned axis) {
    const unsigned u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    const double left = (b[u] - a[u]) * (c[v] - a[v]), right = (b[v] - a[v]) * (c[u] - a[u]);
    const double permanent = std::abs(left) + std::abs(right);
    const int sign = filter::safe_sign(left - right, filter::line_error * permanent + filter::underflow);
    return sign != 0 ? sign : exact_line_side(a, b, c, axis);
}

/// The real number high - low. Requires: both are finite; high >= low.
struct Gap {
    double high = 0;
    double low = 0;
};
using Gaps = std::array<Gap, 3>;

/// Returns -1, 0 or 1 if the sum of the squares of `a` is less than, equal to or greater than that of `b`.
int compare_square_sums(const Gaps& a, const Gaps& b);

/// Compares a root with the middle between `low` and the next larger float64: the root of the sum of the squares of `gaps`. The
/// successor of the largest float64 counts as 2^1024. Returns -1, 0 or 1 if the root is less than, equal to or greater than the
/// middle.
/// Requires: `low` is finite and >= 0.
int compare_root_with_middle(const Gaps& gaps, double low);

}  // namespace octopair
