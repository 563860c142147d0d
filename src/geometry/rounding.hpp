// Outward rounding: bounds of numbers that float32 or float64 cannot represent. boxes/outward_rounding.cpp has finite_float_above()
// for many numbers at a time. The rule for a box with margin and padding is OutwardRounding in boxes/outward_rounding.hpp.
// Start here to change how float64 is rounded.
//
// Invariants
// - A function named `..._above` returns no less than the exact value, and one named `..._below` no more, unless its comment
//   names a bound.
// - Without widening, rounding is monotone: a <= b implies float_above(a) <= float_above(b).
#pragma once

#include <cfloat>
#include <cmath>
#include <limits>

namespace octopair::rounding {

/// Returns the next larger float64; infinity after the largest finite one.
inline double next_above(double value) { return std::nextafter(value, std::numeric_limits<double>::infinity()); }
/// Returns the next smaller float64; -infinity after the smallest finite one.
inline double next_below(double value) { return std::nextafter(value, -std::numeric_limits<double>::infinity()); }
/// Returns the next larger float32; infinity after the largest finite one.
inline float next_above(float value) { return std::nextafter(value, std::numeric_limits<float>::infinity()); }

/// Returns the smallest float32 >= `value`; infinity if there is no finite one.
inline float float_above(double value) {
    const float nearest = float(value);
    return double(nearest) < value ? next_above(nearest) : nearest;
}

/// Returns the smallest float32 >= `value`, but at most FLT_MAX and at least -FLT_MAX. Zero has a positive sign.
inline float finite_float_above(double value) {
    if (value <= -double(FLT_MAX)) return -FLT_MAX;
    if (value >= double(FLT_MAX)) return FLT_MAX;
    return float_above(value) + 0.0F;
}

/// Returns the smallest float64 >= a + b. If the sum overflows, returns infinity with the sign of the sum.
/// Source: Knuth's two-sum, which gives the rounding error of a sum exactly, since additions never underflow.
inline double sum_above(double a, double b) {
    const double sum = a + b;
    if (std::isinf(sum)) return sum;
    const double b_part = sum - a;
    const double error = (a - (sum - b_part)) + (b - b_part);
    return error > 0 ? next_above(sum) : sum;
}

}  // namespace octopair::rounding
