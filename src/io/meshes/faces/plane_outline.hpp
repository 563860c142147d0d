// PlaneOutline: the outline of a face, projected along a coordinate axis. The projection drops one coordinate and keeps the other two
// exact. So all decisions in the plane are exact. OutlineNodes: the corners of an outline in the order of a sweep.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "geometry/exact_sign.hpp"

namespace octopair::io {

/// Polls for a stop request once in many calls. Long computations call it in each step.
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

/// The corners of an outline, numbered by their positions, in the plane perpendicular to an axis.
class PlaneOutline {
public:
    /// Chooses the axis along which the area vector of the outline is largest. Borrows the places and `check`.
    /// Requires: the outline has at least two corners.
    PlaneOutline(std::span<const Point3d> places, StopCheck& check);
    /// Returns an outline of other places in the same plane.
    PlaneOutline with_places(std::span<const Point3d> places) const {
        PlaneOutline other = *this;
        other.places_ = places;
        return other;
    }

    std::uint32_t size() const { return std::uint32_t(places_.size()); }
    /// Returns false if the outline is clockwise in the plane: its area vector points against the axis. True if the area vector is 0.
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
    /// Throws: Error{cancelled}. Long computations that use no other function of this object must call it in each step.
    void check() const { check_(); }

    /// Returns whether the outline is convex. Corners in line and corners at one place in a row count as convex.
    bool is_convex() const;

private:
    std::span<const Point3d> places_;
    StopCheck& check_;
    unsigned axis_ = 0, u_ = 0, v_ = 0;
    bool counterclockwise_ = true;
};

/// An edge between two nodes.
struct OutlineEdge {
    std::uint32_t low, high;   ///< low < high
    int weight;                ///< 1: the outline goes from low to high; -1: from high to low
    std::uint32_t bundle = 0;  ///< set by the sweep
};

/// The corners of an outline in the order of a sweep. Corners at one place of the plane are one node.
/// Nodes are numbered from left to right; those straight above each other, from below.
class OutlineNodes {
public:
    explicit OutlineNodes(const PlaneOutline& outline);

    std::uint32_t size() const { return std::uint32_t(corners_.size()); }
    /// Returns the first corner at a node.
    std::uint32_t corner_of(std::uint32_t node) const { return corners_[node]; }
    std::uint32_t node_of(std::uint32_t corner) const { return nodes_[corner]; }
    /// Returns the places of the nodes' corners.
    const std::vector<Point3d>& places() const { return places_; }

    /// Returns the edges of the outline that are not between two corners of one node.
    std::span<OutlineEdge> edges() { return edges_; }
    /// Return the numbers of the edges whose low or high node is `node`.
    std::span<const std::uint32_t> starting_at(std::uint32_t node) const { return starting_.of(node); }
    std::span<const std::uint32_t> ending_at(std::uint32_t node) const { return ending_.of(node); }

private:
    /// Numbers of the edges at each node.
    struct EdgesByNode {
        std::vector<std::uint32_t> begins, numbers;
        std::span<const std::uint32_t> of(std::uint32_t node) const {
            return std::span(numbers).subspan(begins[node], begins[node + 1] - begins[node]);
        }
    };
    EdgesByNode by_node(std::uint32_t OutlineEdge::*end) const;

    std::vector<std::uint32_t> corners_, nodes_;
    std::vector<Point3d> places_;
    std::vector<OutlineEdge> edges_;
    EdgesByNode starting_, ending_;
};

}  // namespace octopair::io
