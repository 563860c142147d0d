// PairRule: which overlapping entries are pairs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "boxes/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// The rule of objects.hpp; `reach` is margin + (padding_a + padding_b).
inline bool within_reach(const Box3d& a, const Box3d& b, double reach) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(std::max(a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]) <= reach)) return false;
    }
    return true;
}

class PairRule {
public:
    virtual ~PairRule() = default;
    /// Whether pairs are those between two sets, which entries' masks tell apart.
    virtual bool join() const = 0;
    /// Objects of the second set of a join have indices from here on; otherwise 0.
    virtual std::uint32_t second_begin() const = 0;
    /// True if overlapping entries are a pair, without a further test.
    virtual bool exact() const = 0;
    /// A hit that is no deeper than this says counts only if is_pair() says so.
    virtual RoundingSlack slack() const = 0;
    /// On the caller's numbers.
    virtual bool is_pair(std::uint32_t a, std::uint32_t b) const = 0;
};

}  // namespace octopair
