// Oracle for distances between boxes in integers of any size, for tests of the rules of queries.hpp.
//
// Every finite float64 is an integer times 2^-1074, so squared distances are integers times 2^-2148.
#pragma once

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>

#include "octopair/queries.hpp"

namespace octopair::test {

using Integer = boost::multiprecision::cpp_int;

/// Returns value * 2^1074.
inline Integer exact(double value) {
    int exponent = 0;
    const double part = std::frexp(value, &exponent);
    const auto mantissa = std::int64_t(std::ldexp(part, 53));
    const int shift = exponent - 53 + 1074;
    return shift >= 0 ? Integer(mantissa) * (Integer(1) << unsigned(shift))
                      : Integer(mantissa / (std::int64_t(1) << -shift));
}

/// Returns the squared distance between two boxes, times 2^2148.
inline Integer exact_squared_distance(const Box3d& a, const Box3d& b) {
    Integer sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis]) continue;
        const bool above = a.min[axis] > b.max[axis];
        const Integer gap = exact(above ? a.min[axis] : b.min[axis]) - exact(above ? b.max[axis] : a.max[axis]);
        sum += gap * gap;
    }
    return sum;
}

inline Box3d point_box(const double (&at)[3]) { return {{at[0], at[1], at[2]}, {at[0], at[1], at[2]}}; }

inline bool exactly_touches(const Sphere& sphere, const Box3d& box) {
    const Integer radius = exact(sphere.radius);
    return exact_squared_distance(point_box(sphere.centre), box) <= radius * radius;
}

/// Returns the float64 nearest to the distance, with ties to even, or infinity beyond the range of float64.
inline double rounded_distance(const Integer& squared) {
    if (squared == 0) return 0;
    // The root is the distance times 2^(1074 + 64): it has 64 bits below the last bit of the smallest float64.
    Integer rest;
    const Integer root = boost::multiprecision::sqrt(Integer(squared << 128), rest);
    const int bits = int(msb(root)) + 1, dropped = std::max(bits - 53, 64);
    Integer kept = root >> unsigned(dropped);
    const Integer tail = root - (kept << unsigned(dropped)), half = Integer(1) << unsigned(dropped - 1);
    if (tail > half || (tail == half && (rest != 0 || (kept & 1) != 0))) ++kept;
    return std::ldexp(double(std::uint64_t(kept)), dropped - 64 - 1074);
}

inline double rounded_distance(const Box3d& a, const Box3d& b) {
    return rounded_distance(exact_squared_distance(a, b));
}

}  // namespace octopair::test
