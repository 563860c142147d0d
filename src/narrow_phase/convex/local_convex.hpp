// LocalConvexPair: two convex objects in local coordinates near the smaller object.
// ScaledPair: copies of two very large or very small convex objects, in units in which their numbers are about 1.
//
// Origin    A point of the smaller object: its first corner, its first point or its centre. The axes are those of the world.
// Order     a() is the larger object and b() the smaller one, whichever the caller passes first (see swapped()).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "narrow_phase/convex/convex_pair.hpp"

namespace octopair {

/// A convex object in local coordinates. Cannot be copied or moved.
class LocalConvex {
public:
    LocalConvex(const PosedConvex& convex, const Point3d& origin);
    LocalConvex(const LocalConvex&) = delete;
    LocalConvex& operator=(const LocalConvex&) = delete;

    /// Returns the core's farthest point in `direction`, which may have any length.
    Point3d support(const Point3d& direction) const;
    double radius() const { return solid_ ? solid_->radius : 0; }
    /// Upper bound on the absolute value of the core's coordinates; rounding errors are a few epsilon of this.
    double magnitude() const { return magnitude_; }
    /// Returns a point inside the core.
    Point3d middle() const;
    /// Points of the core in local coordinates; empty if there are more than 4 or the core is not a set of points.
    std::span<const Point3d> points() const { return {points_.data(), count_}; }
    /// True if the core is the convex hull of a set of points.
    bool is_points() const { return count_ > 0 || solid_->core == ConvexSolid::Core::points; }
    /// True if the core has a curved surface.
    bool is_curved() const { return !is_points() && solid_->core != ConvexSolid::Core::box; }
    /// Returns all points of the core in local coordinates; empty if the core is not a set of points.
    std::vector<Point3d> all_points() const;
    /// Pose of the solid in local coordinates; the identity for triangles and points.
    const Pose& pose() const { return pose_; }

private:
    void take(const Point3d& point);

    const ConvexSolid* solid_ = nullptr;
    Pose pose_;
    std::array<Point3d, 4> points_ = {};
    std::size_t count_ = 0;  // number of points_; 0: the support is computed from solid_
    double magnitude_ = 0;
};

class LocalConvexPair {
public:
    LocalConvexPair(const PosedConvex& a, const PosedConvex& b);

    const LocalConvex& a() const { return a_; }
    const LocalConvex& b() const { return b_; }
    const Point3d& origin() const { return origin_; }
    /// True if a() is the caller's b.
    bool swapped() const { return swapped_; }
    /// Upper bound on the rounding error of a difference of two supports.
    double slack() const;
    double radii() const { return a_.radius() + b_.radius(); }
    /// Upper bound on the absolute value of all coordinates and radii.
    double size() const { return size_; }

private:
    bool swapped_;
    Point3d origin_;
    LocalConvex a_, b_;
    double size_;
};

/// Bounds on the distance of two cores, and two points that are `at_most` apart.
struct CoreGap {
    double at_most = 0, at_least = 0;
    /// Unit vector from b to a that proves `at_least`, if that is above 0. More accurate than on_a - on_b.
    Point3d direction = {};
    Point3d on_a = {}, on_b = {};
};

/// Returns the distance of the two cores. With `enough`, the search ends once the bounds decide whether the distance is
/// larger than `enough`.
CoreGap gjk_distance(const LocalConvexPair& pair, std::optional<double> enough = {});

/// Copies of two convex objects, in units in which their numbers are about 1. The functions of convex_pair.hpp multiply up to four
/// lengths, which may overflow. So they first scale pairs larger than 2^200 or smaller than 2^-200. The unit is a power of two. So
/// scaling rounds only numbers that are 2^800 times smaller than the pair.
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
