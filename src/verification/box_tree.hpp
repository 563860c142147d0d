// BoxTree: a k-d tree over boxes as points of six dimensions (min x, y, z, max x, y, z).
//
// Result     every box of a set that is within reach of a query box. The pair rule of objects.hpp is evaluated in float64, on the
//            numbers that the caller gave.
// Invariants 1. A node covers a run of leaves; a leaf covers `leaf_boxes` boxes (the last leaf may have fewer). The left
//               child covers the first half of the run, and follows its parent. The right child follows the left subtree.
//            2. A node's hull has the least minimum and the greatest maximum of its boxes on each axis. `padding` is the
//               greatest padding and `largest` the greatest index among them.
//            3. A node is skipped only if the rule fails for its hull. Each operation of the rule is monotone in float64:
//               hull.max >= b.max gives query.min - hull.max <= query.min - b.max, and likewise b.min - query.max. A
//               greater padding gives a greater reach. So the rule then fails for each box of the node.
//            4. A run is halved by the median of the coordinate that separates its boxes best. Distances are measured in
//               units of the mean extent of all boxes on the axis. So the depth is log2(n / 16) for any boxes. A family of
//               rods is divided across its length alone, and a flat world on two axes. (Cycling through the six coordinates
//               bounds a query by O(n^(5/6) + found) nodes. But it visits 50 times as many nodes on plates, twice on rods.)
// Memory     float32: 33 bytes a box; float64: 64 bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/objects.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// A query: a box in the caller's numbers, and the margin and padding that determine which boxes are within its reach.
struct BoxQuery {
    Box3d box;
    double padding = 0;
    double margin = 0;
    std::int64_t above = -1;  ///< only boxes with a larger index are found
};

/// Returns whether `box` is within reach of the query, by the rule of objects.hpp. `padding`: padding of `box`.
template <typename Real>
bool is_within_reach(const BoxQuery& query, const Box<Real>& box, double padding) {
    const double reach = query.margin + (query.padding + padding);
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double below = query.box.min[axis] - double(box.max[axis]);
        const double beyond = double(box.min[axis]) - query.box.max[axis];
        within &= (below <= reach) & (beyond <= reach);
    }
    return within;
}

template <typename Real>
class BoxTree {
public:
    /// Copies the boxes. Requires: `padding` is empty or has one value a box.
    /// Throws: Error{engine_failed} for a box or a padding that is not valid (an engine refuses those before), and
    /// Error{cancelled}, std::bad_alloc. Complexity: O(n log n) / threads of the team, and O(n) on one thread.
    BoxTree(std::span<const Box<Real>> boxes, std::span<const double> padding, Team& team, const std::stop_token& stop);

    /// Appends the index of each box within reach of the query, in no particular order. Thread safety: full.
    void find(const BoxQuery& query, std::vector<std::uint32_t>& found) const;

private:
    static constexpr std::size_t leaf_boxes = 16;

    struct Item {
        Box<Real> box;
        std::uint32_t index;
    };
    struct Node {
        Box<Real> hull;
        std::uint32_t largest;
        double padding;
    };
    /// A node and the run of leaves that it covers.
    struct Place {
        std::size_t node, first_leaf, leaves;
    };
    class Builder;

    Place left_of(const Place& place) const { return {place.node + 1, place.first_leaf, place.leaves / 2}; }
    Place right_of(const Place& place) const {
        const std::size_t left = place.leaves / 2;  // a subtree of L leaves has 2 L - 1 nodes
        return {place.node + 2 * left, place.first_leaf + left, place.leaves - left};
    }
    std::size_t begin_of(const Place& place) const { return place.first_leaf * leaf_boxes; }
    std::size_t end_of(const Place& place) const;
    double padding_of(std::size_t index) const { return padding_.empty() ? 0 : padding_[index]; }
    void find_in_leaf(const BoxQuery& query, const Place& leaf, std::vector<std::uint32_t>& found) const;

    std::vector<Item> items_;
    std::vector<Node> nodes_;
    std::span<const double> padding_;  // the caller's array, by index
};

}  // namespace octopair
