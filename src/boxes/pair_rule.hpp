// PairRule: decides which overlapping entries are pairs.
// Start here to change which boxes count as a pair.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// True if the pair rule of octopair/objects.hpp holds. `reach`: margin + (padding_a + padding_b).
inline bool within_reach(const Box3d& a, const Box3d& b, double reach) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(std::max(a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]) <= reach)) return false;
    }
    return true;
}

/// Pairs of overlapping entries. Those in doubt may overlap only because entries are rounded outward, so they need an exact test.
struct DoubtfulPairs {
    std::span<const Pair> pairs;
    std::span<const std::uint32_t> positions;  ///< positions of the pairs in doubt

    const Pair& operator[](std::size_t i) const { return pairs[positions[i]]; }
    std::size_t size() const { return positions.size(); }
};

class OCTOPAIR_PRIVATE_EXPORT PairRule {
public:
    virtual ~PairRule() = default;
    /// True if only pairs between two sets count. The masks of entries separate the sets.
    virtual bool join() const = 0;
    /// Returns the index of the first object of the second set of a join; otherwise 0.
    virtual std::uint32_t second_begin() const = 0;
    /// True if any two overlapping entries are a pair, without a further test.
    virtual bool exact() const = 0;
    /// Returns the slack of entries. Entries that overlap by no more than the slack need the test is_pair().
    virtual RoundingSlack slack() const = 0;
    /// True if the caller's own boxes, before any rounding, are a pair.
    virtual bool is_pair(std::uint32_t a, std::uint32_t b) const = 0;
    /// Writes the positions of the doubtful pairs that fail the test is_pair() to `out`, in the same order, and returns their number.
    /// Requires: `out` has room for all positions.
    virtual std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const = 0;
    /// Sets the bounds of entries whose object is set.
    virtual void load_bounds(std::span<Entry> entries) const = 0;

protected:
    /// Does what refused() does, with a call of is_pair() for each pair in doubt.
    std::size_t refused_one_by_one(const DoubtfulPairs& doubtful, std::uint32_t* out) const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < doubtful.size(); ++i) {
            out[count] = doubtful.positions[i];
            count += is_pair(doubtful[i].a, doubtful[i].b) ? 0 : 1;
        }
        return count;
    }
};

}  // namespace octopair
