// PairRule: decides which overlapping entries are pairs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "boxes/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// The pair rule of octopair/objects.hpp. `reach`: margin + (padding_a + padding_b).
inline bool within_reach(const Box3d& a, const Box3d& b, double reach) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(std::max(a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]) <= reach)) return false;
    }
    return true;
}

class PairRule {
public:
    virtual ~PairRule() = default;
    /// True if only pairs between two sets count. The masks of entries separate the sets.
    virtual bool join() const = 0;
    /// Returns the index of the first object of the second set of a join; otherwise 0.
    virtual std::uint32_t second_begin() const = 0;
    /// True if any two overlapping entries are a pair, without a further test.
    virtual bool exact() const = 0;
    /// Returns the slack of entries: a hit that is no deeper needs the test is_pair().
    virtual RoundingSlack slack() const = 0;
    /// True if the objects are a pair by the caller's own numbers.
    virtual bool is_pair(std::uint32_t a, std::uint32_t b) const = 0;
};

}  // namespace octopair
