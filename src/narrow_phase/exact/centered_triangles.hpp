// CenteredTriangles: two triangles, translated so that the first corner of the first triangle is the origin.
//
// Coordinates are first divided by a power of two if they are so large or so small that products would leave float64's range.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/vector.hpp"
#include "octopair/pose.hpp"

namespace octopair {

struct CenteredTriangles {
    int exponent = 0;  ///< coordinates were divided by 2^exponent
    Point3d origin;    ///< the new origin, after that division
    Triangle3d a, b;

    CenteredTriangles(const Triangle3d& first, const Triangle3d& second) : a(first), b(second) {
        const double largest = std::max(largest_of(a), largest_of(b));
        // Differences may be as small as 2^-53 of this, and products have up to six factors.
        if (largest > 0x1p100 || (largest < 0x1p-50 && largest > 0)) exponent = std::ilogb(largest) + 1;
        origin = scaled(a[0]);
        for (auto* triangle : {&a, &b}) {
            for (Point3d& corner : *triangle) corner = vector::minus(scaled(corner), origin);
        }
    }

    /// Returns a point or a length in the coordinates of the given triangles.
    Point3d back(const Point3d& place) const {
        const Point3d there = vector::plus(place, origin);
        if (exponent == 0) return there;
        return {back(there[0]), back(there[1]), back(there[2])};
    }
    double back(double length) const { return exponent == 0 ? length : std::scalbn(length, exponent); }

private:
    static double largest_of(const Triangle3d& triangle) {
        double largest = 0;
        for (const Point3d& corner : triangle) {
            for (const double at : corner) largest = std::max(largest, std::abs(at));
        }
        return largest;
    }
    Point3d scaled(const Point3d& corner) const {
        if (exponent == 0) return corner;
        return {std::scalbn(corner[0], -exponent), std::scalbn(corner[1], -exponent),
                std::scalbn(corner[2], -exponent)};
    }
};

}  // namespace octopair
