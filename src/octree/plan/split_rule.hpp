// SplitRule: decides on a sample of the scene which octants of a linear octree are split.
// Start here to change when an octant is split.
//
// An octant is split if it is crowded: it holds too many objects, or a sweep along its best axis would test too many. It is
// not split if the split
//   would multiply entries (boxes as large as the octant), or
//   would copy the boxes handed down from above into the children without thinning them.
//
// The thresholds are in base/tuning.hpp (Tuning::Split).
//
// Decisions depend only on sums over the sampled boxes, and on their least and greatest cells. So parts of a sample can be
// counted separately, and the order of boxes does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "base/private_export.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// An octant by its position alone: first cell on each axis, and level. The side is 2^(21 - level) cells.
struct OCTOPAIR_PRIVATE_EXPORT OctantCube {
    Cell lo = {};
    unsigned level = 0;

    OctantCube child(unsigned digit) const;
    /// Returns a bit mask of the children that `box` touches.
    /// Requires: `box` touches this octant.
    unsigned touched_below(const CellBox& box) const {
        // For each axis: bit mask of the children in the lower half, and bit mask of the children in the upper half.
        constexpr std::array<std::array<unsigned, 2>, 3> halves = {{{0x55, 0xAA}, {0x33, 0xCC}, {0x0F, 0xF0}}};
        const std::uint32_t half = (cells_per_axis >> level) / 2;
        unsigned touched = 0xFF;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t middle = lo[axis] + half;
            touched &= (box.lo[axis] < middle ? halves[axis][0] : 0) | (box.hi[axis] >= middle ? halves[axis][1] : 0);
        }
        return touched;
    }
    /// True if `box` begins in this octant.
    /// Requires: `box` touches this octant.
    bool holds_begin(const CellBox& box) const {
        return box.lo[0] >= lo[0] && box.lo[1] >= lo[1] && box.lo[2] >= lo[2];
    }
    /// True if `box` is too large for the octants below.
    bool keeps(const CellBox& box) const { return natural_level(box) <= level; }
};

/// Shape of a subtree: for each octant, in pre-order, 1 if it is split, otherwise 0.
using SplitFlags = std::vector<std::uint8_t>;

/// An octant and the sampled boxes that touch it.
struct SampledOctant {
    using Boxes = std::vector<CellBox>;
    OctantCube octant;
    Boxes inside;  ///< boxes that fit into the octants below
    Boxes kept;    ///< boxes that this octant or an octant above keeps

    /// Moves the boxes that do not fit into the octants below from `inside` to `kept`. Must be called before divided().
    void keep();
    /// Returns the children and their boxes, before keep() of each child.
    std::array<SampledOctant, 8> divided() const;
};

/// Numbers of sampled boxes in an octant, after keep(), and in the children that a split would make.
struct OctantCounts {
    std::uint64_t inside = 0, kept = 0;
    std::uint64_t beginning = 0;                     ///< boxes of `inside` that begin in the octant
    std::uint64_t inside_below = 0, kept_below = 0;  ///< sums over the children that the boxes touch

    static OctantCounts of(const SampledOctant& sampled, const std::array<SampledOctant, 8>& below);
};

class OCTOPAIR_PRIVATE_EXPORT SplitRule {
public:
    /// `weight`: number of objects that a sampled box represents.
    SplitRule(double weight, std::stop_token stop) : weight_(weight), stop_(std::move(stop)) {}

    /// True if `inside` sampled boxes are too many for one octant, wherever they are in it.
    bool is_crowd(std::uint64_t inside) const;
    bool crowded(const SampledOctant& sampled) const;
    /// True if dividing a crowded octant multiplies neither entries nor boxes handed down.
    static bool worth_splitting(const OctantCounts& counts);

    /// Divides an octant as far as the rule says, and appends the shape of its subtree to `shape`.
    /// Throws: Error{cancelled}.
    void grow(SampledOctant sampled, SplitFlags& shape) const;

private:
    double weight_;
    std::stop_token stop_;
};

}  // namespace octopair
