// PlaneOutline: the outline of a face in one of the planes of the coordinate axes. One coordinate is left out, so the other two stay
// exact, and so are all decisions in the plane.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "geometry/line_side.hpp"

namespace octopair::io {

/// Checks for a stop now and then. Long computations call it in each step.
class StopCheck {
public:
    /// Borrows `stop`: it must outlive this object.
    explicit StopCheck(const std::stop_token& stop) : stop_(stop) {}

    /// Throws: Error{cancelled}.
    void operator()() {
        if (++steps_ % 65536 == 0) check();
    }

private:
    void check() const;

    const std::stop_token& stop_;
    std::uint64_t steps_ = 0;
};

/// The corners of an outline, by their positions, in the plane across an axis.
class PlaneOutline {
public:
    /// Chooses the axis along which the area vector of the outline is largest. Borrows the places and `check`.
    /// Requires: the outline has at least two corners.
    PlaneOutline(std::span<const Point3d> places, StopCheck& check);
    /// Returns other places in the same plane.
    PlaneOutline with_places(std::span<const Point3d> places) const {
        PlaneOutline other = *this;
        other.places_ = places;
        return other;
    }

    std::uint32_t size() const { return std::uint32_t(places_.size()); }
    /// Returns whether the area vector points along the axis, or is 0: otherwise the outline is clockwise in the plane.
    bool is_counterclockwise() const { return counterclockwise_; }

    /// Returns line_side() in the plane: 1 if c is left of the line from a to b, -1 if it is right of it, 0 if it is on it.
    int side(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        check_();
        return line_side(places_[a], places_[b], places_[c], axis_);
    }
    /// Returns -1 if corner a is left of corner b in the plane, or straight below it; 0 if they coincide; 1 otherwise.
    int compare(std::uint32_t a, std::uint32_t b) const {
        check_();
        const Point3d &one = places_[a], &other = places_[b];
        for (const unsigned axis : {u_, v_}) {
            if (one[axis] != other[axis]) return one[axis] < other[axis] ? -1 : 1;
        }
        return 0;
    }
    const Point3d& place(std::uint32_t corner) const { return places_[corner]; }
    /// Throws: Error{cancelled}. Computations that call nothing else of this object call it now and then.
    void check() const { check_(); }

    /// Returns whether the outline is convex. Corners in line and corners at one place in a row count as convex.
    bool is_convex() const;

private:
    std::span<const Point3d> places_;
    StopCheck& check_;
    unsigned axis_ = 0, u_ = 0, v_ = 0;
    bool counterclockwise_ = true;
};

}  // namespace octopair::io
