// SplitRule: which octants of a linear octree are divided, decided on a sample of the scene.
//
// An octant is divided while it is crowded: while it holds too many objects, or a sweep along its best axis would test too
// many; but not where dividing would multiply entries (boxes as large as the octant), nor where the boxes handed down from
// above would be copied into the children without being thinned.
//
// All that a decision asks of a sample are sums over its boxes, and least and greatest cells: so a sample's parts can be
// counted apart, and their order does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "octree/space.hpp"

namespace octopair {

/// An octant by its first cell on each axis; its side is 2^(21 - level) cells.
struct OctantCube {
    Cell lo = {};
    unsigned level = 0;

    OctantCube child(unsigned digit) const;
    /// As bits, the octants below that a box touches which touches this one.
    unsigned touched_below(const CellBox& box) const {
        // Per axis those of the lower and of the upper half.
        constexpr std::array<std::array<unsigned, 2>, 3> halves = {{{0x55, 0xAA}, {0x33, 0xCC}, {0x0F, 0xF0}}};
        const std::uint32_t half = (cells_per_axis >> level) / 2;
        unsigned touched = 0xFF;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t middle = lo[axis] + half;
            touched &= (box.lo[axis] < middle ? halves[axis][0] : 0) | (box.hi[axis] >= middle ? halves[axis][1] : 0);
        }
        return touched;
    }
    /// Whether a box that touches it begins in it.
    bool holds_begin(const CellBox& box) const {
        return box.lo[0] >= lo[0] && box.lo[1] >= lo[1] && box.lo[2] >= lo[2];
    }
    /// Whether a box is too large for the octants below.
    bool keeps(const CellBox& box) const { return natural_level(box) <= level; }
};

/// In pre-order, of each octant of a subtree: whether it is divided.
using SplitFlags = std::vector<std::uint8_t>;

/// The sampled boxes that touch an octant.
struct SampledOctant {
    using Boxes = std::vector<CellBox>;
    OctantCube octant;
    Boxes inside;  ///< those that fit into the octants below,
    Boxes kept;    ///< and those that octants above keep, or this one

    /// Takes what does not fit into the octants below from the one to the other. To be called first.
    void keep();
    /// The octants below, not yet kept.
    std::array<SampledOctant, 8> divided() const;
};

/// Of a sample in an octant, after keep(), and of what it would make in the octants below.
struct OctantCounts {
    std::uint64_t inside = 0, kept = 0;
    std::uint64_t beginning = 0;                     ///< of those inside: which begin in it
    std::uint64_t inside_below = 0, kept_below = 0;  ///< boxes for each octant below that they touch, added up

    static OctantCounts of(const SampledOctant& sampled, const std::array<SampledOctant, 8>& below);
};

class SplitRule {
public:
    /// `weight`: how many objects a box of the sample stands for.
    SplitRule(double weight, std::stop_token stop) : weight_(weight), stop_(std::move(stop)) {}

    /// Whether that many are too many, wherever they are.
    bool is_crowd(std::uint64_t inside) const;
    bool crowded(const SampledOctant& sampled) const;
    /// Of a crowded octant.
    static bool worth_dividing(const OctantCounts& counts);

    /// Appends the shape of an octant's subtree. Throws Error{cancelled}.
    void grow(SampledOctant sampled, SplitFlags& shape) const;

private:
    double weight_;
    std::stop_token stop_;
};

}  // namespace octopair
