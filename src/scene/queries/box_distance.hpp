// Distances between boxes, and between spheres and boxes. Comparisons are exact. A returned distance is rounded once.
//
// Invariants
//   - Comparisons treat each float64 as an exact real number: differences are not rounded, nothing overflows or underflows.
//   - A comparison is computed in float64 first, with an error bound. If that cannot decide, integers of sufficient width do
//     (geometry/exact_sign.hpp).
//   - distance() is monotone: if compare_distances() says that `a` is nearer than `b`, distance() of `a` is not larger.
//
// Requires: rounding to nearest, with subnormal numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/exact_sign.hpp"
#include "octopair/queries.hpp"

namespace octopair {

/// A squared distance in float64. If within() holds, its relative error is less than `error`: gaps, squares and sums have a
/// relative error of 2^-53 each, and terms that underflow are far below.
struct RoundedSquare {
    static constexpr double error = 0x1p-50;
    double value = 0;

    static constexpr double least = 0x1p-900, most = 0x1p1000;
    static bool within(double value) { return value >= least && value <= most; }
    void add(double gap) { value += gap * gap; }
    /// Compares the exact squared distances: returns -1 or 1; 0 if float64 cannot decide.
    int compare(const RoundedSquare& other) const {
        const double sum = value + other.value, difference = value - other.value;
        if (!within(sum)) return 0;
        return int(difference > 2 * error * sum) - int(difference < -2 * error * sum);
    }
};

/// Returns the gap between two boxes on an axis, rounded to float64: 0 if they overlap, infinity beyond float64.
inline double rounded_gap(const Box3d& a, const Box3d& b, int axis) {
    return std::max({0.0, a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]});
}

inline RoundedSquare rounded_square(const Box3d& a, const Box3d& b) {
    RoundedSquare square;
    for (int axis = 0; axis < 3; ++axis) square.add(rounded_gap(a, b, axis));
    return square;
}

bool exactly_overlap(const Sphere& sphere, const Box3d& box);
int exactly_compare_distances(const Box3d& from, const Box3d& a, const Box3d& b);

/// Returns whether the box is no farther from the centre than the radius.
inline bool overlap(const Sphere& sphere, const Box3d& box) {
    RoundedSquare apart, radius;
    for (int axis = 0; axis < 3; ++axis) {
        const double centre = sphere.centre[axis];
        apart.add(std::max({0.0, box.min[axis] - centre, centre - box.max[axis]}));
    }
    radius.add(sphere.radius);
    const int sign = apart.compare(radius);
    return sign != 0 ? sign < 0 : exactly_overlap(sphere, box);
}

/// Compares the distances from `from` to `a` and to `b`. Returns -1 if `a` is nearer, 0 if they are equal, 1 if `b` is nearer.
inline int compare_distances(const Box3d& from, const Box3d& a, const Box3d& b) {
    const int sign = rounded_square(from, a).compare(rounded_square(from, b));
    return sign != 0 ? sign : exactly_compare_distances(from, a, b);
}

/// Returns the distance between two boxes, rounded to the nearest float64, ties to even; infinity if it is beyond float64.
double distance(const Box3d& a, const Box3d& b);

// Two functions find most boxes that are farther than a distance without a square root: if square_at_least(a, b) > square_at_most(d),
// distance(a, b) > d.

/// Returns the squared distance between two boxes, or a lower value. A box may be infinite; the bound then holds for each box inside it.
inline double square_at_least(const Box3d& a, const Box3d& b) {
    const double square = rounded_square(a, b).value;
    return square < RoundedSquare::least ? 0 : std::min(square, RoundedSquare::most);
}

/// Returns a value that square_at_least() of two boxes does not exceed if distance() of them is at most `distance`. The factor covers the
/// errors of both squares. Outside the range in which RoundedSquare is accurate, the value is larger, so it excludes fewer boxes.
inline double square_at_most(double distance) {
    constexpr double errors = 4 * RoundedSquare::error;
    const double square = distance * distance * (1 + errors);
    return square < RoundedSquare::most / 2 ? std::max(square, 2 * RoundedSquare::least)
                                            : std::numeric_limits<double>::infinity();
}

}  // namespace octopair
