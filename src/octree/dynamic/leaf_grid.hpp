// LeafGrid: an octant of a MutableOctree as it is cut into units, and boxes in the numbers of a unit.
//
// A leaf is cut into a grid of cells, 2^bits on an axis, so that a cell holds a few entries; an inner octant is not. The units
// of a grid are its own, the whole octant, and those cells; they are numbered from `begin` on, its own first.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "octree/directory.hpp"
#include "octree/dynamic/small_block.hpp"
#include "octree/space.hpp"

namespace octopair {

/// What keeps entries.
struct Unit {
    Cell lo = {};                     ///< its first cell of the space
    std::array<float, 4> scale = {};  ///< numbers of a SmallBox a cell of the space
    std::uint32_t index = 0;

    SmallBox small(const CellBox& box) const;
    /// Where an entry's box lies in the unit, or a little more.
    CellBox cells(const SmallBox& box) const;
};

/// A block of a grid's cells, both ends included.
struct GridRange {
    using Place = std::array<std::uint32_t, 3>;
    Place first, last;

    static constexpr GridRange empty() { return {{1, 0, 0}, {0, 0, 0}}; }
    std::uint32_t count() const {
        return (last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    }
    bool holds(const Place& place) const {
        bool held = true;
        for (unsigned axis = 0; axis < 3; ++axis) held &= first[axis] <= place[axis] && place[axis] <= last[axis];
        return held;
    }
};

struct alignas(32) LeafGrid {
    std::array<std::uint32_t, 3> lo;  ///< the octant's first cell of the space
    std::uint32_t begin;
    std::uint8_t level;
    std::array<std::uint8_t, 3> bits;
    bool inner;  ///< no leaf
    bool used;   ///< its own unit may hold entries

    /// Cuts an octant for the boxes that have entries in it.
    static LeafGrid cut(const Octant& octant, std::uint32_t begin, std::span<const CellBox> boxes);
    /// How many units it has.
    std::size_t units() const { return inner ? 1 : 1 + (std::size_t(1) << (bits[0] + bits[1] + bits[2])); }

    std::uint32_t last(unsigned axis) const { return lo[axis] + ((cells_per_axis >> level) - 1); }
    bool touches(const CellBox& box) const {
        bool touched = true;
        for (unsigned axis = 0; axis < 3; ++axis) touched &= box.lo[axis] <= last(axis) && box.hi[axis] >= lo[axis];
        return touched;
    }
    /// Whether it keeps an entry, itself or in a cell, of a box of that natural level.
    bool keeps(const CellBox& box, unsigned natural) const {
        return (inner ? level == natural : level <= natural) && touches(box);
    }
    /// Whether the cells keep entries of a box that touches these; otherwise the octant itself.
    bool keeps_in(const GridRange& range) const {
        constexpr std::uint32_t most_cells_an_entry = 8;
        return !inner && range.count() <= most_cells_an_entry;
    }

    CellBox cells() const;
    CellBox cells(const GridRange& range) const;
    Unit own_unit() const;
    GridRange all() const;
    /// The cells that a box touches, which touches the grid.
    GridRange range_of(const CellBox& box) const;
    /// Calls visit(unit, place in the grid).
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
