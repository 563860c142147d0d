// Distances between boxes, and between spheres and boxes: compared without error, and rounded once where they are numbers.
//
//   - All numbers are the caller's float64, each taken for the real number that it is: differences are not rounded, and
//     nothing overflows or underflows.
//   - What is compared is first computed in float64. An error bound tells whether that decides; if not, integers do
//     (geometry/square_sum.hpp).
//   - distance() is monotone: what is nearer by compare_distances() has no larger distance().
//
// Requires: rounding to nearest, with subnormal numbers.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/square_sum.hpp"
#include "octopair/queries.hpp"

namespace octopair {

/// A squared distance in float64. Where within() holds it errs by less than `error` of itself: gaps, squares and sums err
/// by 2^-53 of themselves each, and what underflows is far below.
struct RoundedSquare {
    static constexpr double error = 0x1p-50;
    double value = 0;

    static bool within(double value) { return value >= 0x1p-900 && value <= 0x1p1000; }
    void add(double gap) { value += gap * gap; }
    /// Returns -1 or 1: how the numbers compare that were rounded; 0: float64 does not decide that.
    int compare(const RoundedSquare& other) const {
        const double sum = value + other.value, difference = value - other.value;
        if (!within(sum)) return 0;
        return int(difference > 2 * error * sum) - int(difference < -2 * error * sum);
    }
};

/// Returns the gap between two boxes on an axis, rounded; 0 where they overlap. Infinite where it is beyond float64.
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
double extreme_distance_at_least(const Box3d& a, const Box3d& b);

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

/// Returns -1, 0 or 1: how the distance between `from` and `a` compares with that between `from` and `b`.
inline int compare_distances(const Box3d& from, const Box3d& a, const Box3d& b) {
    const int sign = rounded_square(from, a).compare(rounded_square(from, b));
    return sign != 0 ? sign : exactly_compare_distances(from, a, b);
}

/// Returns the float64 nearest to the distance between two boxes (of two, the one whose last bit is 0); infinity where the
/// distance is beyond float64.
double distance(const Box3d& a, const Box3d& b);

/// Returns at most distance(), and little less. A box may be infinite; then it is also at most the distance() to every
/// box inside of it.
inline double distance_at_least(const Box3d& a, const Box3d& b) {
    const double square = rounded_square(a, b).value;
    return RoundedSquare::within(square) ? std::sqrt(square) * (1 - 2 * RoundedSquare::error)
                                         : extreme_distance_at_least(a, b);
}

}  // namespace octopair
