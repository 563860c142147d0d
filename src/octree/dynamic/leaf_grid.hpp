// LeafGrid: cuts an octant of a MutableOctree into units, and converts boxes to the 8-bit numbers of a unit.
//
// Invariants
//   A leaf is cut into a grid of cells, 2^bits on each axis, so that a cell holds a few entries. An inner octant is not cut.
//   The units of a grid are the octant's own unit, which is the whole octant, and the cells. Units have consecutive numbers from `begin`
//   on; the own unit is number `begin`.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "octree/dynamic/region_map.hpp"
#include "octree/dynamic/small_block.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// A region of the space that keeps entries: an octant or a cell of its grid.
struct Unit {
    /// Largest number of a SmallBox for a place in the unit. Numbers are 1 to `last_number`, 0 before the unit, one more after it.
    static constexpr int last_number = 254;

    Cell lo = {};                     ///< first cell of the space
    std::array<float, 4> scale = {};  ///< numbers of a SmallBox for each cell of the space
    std::uint32_t index = 0;

    SmallBox small(const CellBox& box) const;
    /// Returns the region of the part of an entry's box within the unit.
    CellRegion region(const SmallBox& box) const {
        CellRegion region;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double cells = 1 / double(scale[axis]), first = double(lo[axis]);
            region.lo[axis] = first + double(std::max(1, int(box.lo(axis))) - 1) * cells;
            region.hi[axis] = first + double(std::min(last_number, int(box.hi(axis)))) * cells;
        }
        return region;
    }
};

/// A block of a grid's cells, both ends included.
struct GridRange {
    using Place = std::array<std::uint32_t, 3>;
    Place first, last;

    static constexpr GridRange empty() { return {{1, 0, 0}, {0, 0, 0}}; }
    std::uint32_t count() const {
        return (last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    }
    /// Returns the number of cells on an axis; 0 or less for an empty range.
    int length(unsigned axis) const { return int(last[axis]) - int(first[axis]) + 1; }
    /// Returns the cells of both ranges.
    GridRange common(const GridRange& other) const {
        GridRange common;
        for (unsigned axis = 0; axis < 3; ++axis) {
            common.first[axis] = std::max(first[axis], other.first[axis]);
            common.last[axis] = std::min(last[axis], other.last[axis]);
        }
        return common;
    }
    bool holds(const Place& place) const {
        bool held = true;
        for (unsigned axis = 0; axis < 3; ++axis) held &= first[axis] <= place[axis] && place[axis] <= last[axis];
        return held;
    }
};

struct alignas(32) LeafGrid {
    std::array<std::uint32_t, 3> lo;  ///< first cell of the space in the octant
    std::uint32_t begin;
    std::uint8_t level;
    std::array<std::uint8_t, 3> bits;
    bool inner;  ///< true if the octant is not a leaf
    bool used;   ///< true if the own unit may hold entries

    /// Cuts an octant into cells that suit `boxes`, the boxes with entries in the octant. `begin`: number of the grid's first unit.
    static LeafGrid cut(const Octant& octant, std::uint32_t begin, std::span<const CellBox> boxes);
    /// Returns the number of units.
    std::size_t units() const { return inner ? 1 : 1 + (std::size_t(1) << (bits[0] + bits[1] + bits[2])); }

    std::uint32_t last(unsigned axis) const { return lo[axis] + ((cells_per_axis >> level) - 1); }
    bool touches(const CellBox& box) const {
        bool touched = true;
        for (unsigned axis = 0; axis < 3; ++axis) touched &= box.lo[axis] <= last(axis) && box.hi[axis] >= lo[axis];
        return touched;
    }
    /// True if the own unit or cells of the grid keep entries of `box`. `natural`: natural level of the box.
    bool keeps(const CellBox& box, unsigned natural) const {
        return (inner ? level == natural : level <= natural) && touches(box);
    }
    /// True if each cell of `range` keeps an entry of a box that touches these cells. Otherwise the own unit keeps the box's only entry.
    bool keeps_in(const GridRange& range) const {
        constexpr std::uint32_t max_cells_per_entry = 8;
        return !inner && range.count() <= max_cells_per_entry;
    }

    /// Returns the first cell of the space on an axis of the grid's cells at `place`.
    std::uint32_t first_cell(unsigned axis, std::uint32_t place) const { return lo[axis] + (place << side(axis)); }
    CellRegion region() const;
    CellRegion region(const GridRange& range) const;
    Unit own_unit() const;
    GridRange all() const;
    /// Returns the cells of the grid that `box` touches.
    /// Requires: `box` touches the octant.
    GridRange range_of(const CellBox& box) const;
    /// Calls visit(unit, place in the grid) for each cell of `range`.
    template <typename Visit>
    void for_each_cell(const GridRange& range, Visit&& visit) const;

private:
    unsigned side(unsigned axis) const { return deepest - level - bits[axis]; }
    static float scale_of(unsigned side);
};

template <typename Visit>
void LeafGrid::for_each_cell(const GridRange& range, Visit&& visit) const {
    Unit unit;
    for (unsigned axis = 0; axis < 3; ++axis) unit.scale[axis] = scale_of(side(axis));
    GridRange::Place at;
    for (at[2] = range.first[2]; at[2] <= range.last[2]; ++at[2]) {
        for (at[1] = range.first[1]; at[1] <= range.last[1]; ++at[1]) {
            for (at[0] = range.first[0]; at[0] <= range.last[0]; ++at[0]) {
                for (unsigned axis = 0; axis < 3; ++axis) unit.lo[axis] = lo[axis] + (at[axis] << side(axis));
                unit.index = begin + 1 + ((at[2] << bits[1] | at[1]) << bits[0] | at[0]);
                visit(unit, at);
            }
        }
    }
}

}  // namespace octopair
