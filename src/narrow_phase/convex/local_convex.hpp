// LocalConvexPair: two convex things in a frame at the smaller of them, in an order that does not depend on which came first.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "narrow_phase/convex/convex_pair.hpp"

namespace octopair {

/// One of the two: its support in the frame. Neither copied nor moved.
class LocalConvex {
public:
    LocalConvex(const PosedConvex& convex, const Point3d& origin);
    LocalConvex(const LocalConvex&) = delete;
    LocalConvex& operator=(const LocalConvex&) = delete;

    /// The core's farthest point.
    Point3d support(const Point3d& direction) const;
    double radius() const { return solid_ ? solid_->radius : 0; }
    /// No coordinate of the core is larger, so rounding is at most some epsilon of it.
    double magnitude() const { return magnitude_; }
    /// A point inside.
    Point3d middle() const;
    /// The core in the frame, if it is few points.
    std::span<const Point3d> points() const { return {points_.data(), count_}; }
    /// However many points the core is; of other cores, none.
    std::vector<Point3d> all_points() const;
    /// Where the frame has the solid; of a triangle and a point, which are there already, the identity.
    const Pose& pose() const { return pose_; }

private:
    void take(const Point3d& point);

    const ConvexSolid* solid_ = nullptr;
    Pose pose_;
    std::array<Point3d, 4> points_ = {};
    std::size_t count_ = 0;  // 0: the support is the solid's
    double magnitude_ = 0;
};

class LocalConvexPair {
public:
    LocalConvexPair(const PosedConvex& a, const PosedConvex& b);

    const LocalConvex& a() const { return a_; }
    const LocalConvex& b() const { return b_; }
    const Point3d& origin() const { return origin_; }
    /// The frame's a is the caller's b.
    bool swapped() const { return swapped_; }
    /// What rounding may make of a difference of two supports.
    double slack() const;
    double radii() const { return a_.radius() + b_.radius(); }

private:
    bool swapped_;
    Point3d origin_;
    LocalConvex a_, b_;
};

/// How far two cores are apart, and the points that are.
struct CoreGap {
    double at_most = 0, at_least = 0;
    Point3d on_a = {}, on_b = {};
};

/// Until the bounds have met, or whether they are further apart than `enough` is decided.
CoreGap core_gap(const LocalConvexPair& frame, std::optional<double> enough = {});

}  // namespace octopair
