// ScaledPair: two convex objects in units in which their numbers have about the size 1.
//
// The functions of pairs multiply up to four lengths. So they first scale a pair whose size is beyond 2^200 or below 2^-200. The unit is a
// power of two, so scaling rounds nothing (but the parts of an object that are 2^800 times smaller than the pair).
#pragma once

#include <array>

#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {

/// A convex object that owns its numbers, in units of 2^exponent. Cannot be copied or moved.
class ScaledConvex {
public:
    ScaledConvex(const PosedConvex& convex, int exponent);
    ScaledConvex(const ScaledConvex&) = delete;
    ScaledConvex& operator=(const ScaledConvex&) = delete;

    const PosedConvex& convex() const { return convex_; }

private:
    ConvexSolid solid_;
    Pose pose_;
    std::array<Point3d, 3> triangle_ = {};
    Point3d point_ = {};
    PosedConvex convex_;  // borrows one of the others
};

class ScaledPair {
public:
    /// Returns true if the functions of pairs must scale a pair of this size.
    static bool is_needed(const LocalConvexPair& pair) {
        const double size = pair.size();
        return size > 0 && !(size >= 0x1p-200 && size <= 0x1p200);
    }

    /// Borrows nothing.
    ScaledPair(const PosedConvex& a, const PosedConvex& b, const LocalConvexPair& pair);

    const PosedConvex& a() const { return a_.convex(); }
    const PosedConvex& b() const { return b_.convex(); }
    double to_units(double length) const;
    double from_units(double length) const;
    Point3d from_units(const Point3d& point) const;

private:
    int exponent_;
    ScaledConvex a_, b_;
};

}  // namespace octopair
