// ScaledPair: two convex objects in units in which their numbers have about the size 1.
//
// The functions of pairs multiply up to four lengths. So they first scale a pair whose size is beyond 2^200 or below 2^-200. The unit is a
// power of two, so scaling rounds nothing (but the parts of an object that are 2^800 times smaller than the pair).
#pragma once

#include <memory>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {

class ScaledPair {
public:
    /// Returns true if the functions of pairs must scale a pair of this size.
    static bool is_needed(const LocalConvexPair& pair) {
        const double size = pair.size();
        return size > 0 && !(size >= 0x1p-200 && size <= 0x1p200);
    }

    /// Copies the numbers of both objects.
    ScaledPair(const PosedConvex& a, const PosedConvex& b, const LocalConvexPair& pair);
    ~ScaledPair();
    ScaledPair(const ScaledPair&) = delete;
    ScaledPair& operator=(const ScaledPair&) = delete;

    const PosedConvex& a() const;
    const PosedConvex& b() const;
    double to_units(double length) const;
    double from_units(double length) const;
    Point3d from_units(const Point3d& point) const;

private:
    struct Scaled;

    int exponent_;
    std::unique_ptr<const Scaled> a_, b_;
};

}  // namespace octopair
