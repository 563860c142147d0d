// Directory: the octants of a linear octree in pre-order, and a lookup from cells to leaves.
//
// Invariants
//   octants()[0] is the root.
//   The subtree of octant i is the octants [i, octants()[i].next).
//   An octant has eight children, in the order of digits, or none.
//   The leaves tile the whole space, so every cell lies in exactly one leaf.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/private_export.hpp"
#include "base/test_hooks.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// An octant by its position alone: first cell on each axis, and level. The side is 2^(21 - level) cells.
struct OCTOPAIR_PRIVATE_EXPORT OctantCube {
    Cell lo = {};
    unsigned level = 0;

    OctantCube child(unsigned digit) const;
    /// Returns the digit of the child that holds `cell`, or that is nearest to it.
    unsigned digit(const Cell& cell) const {
        const std::uint32_t half = (cells_per_axis >> level) / 2;
        unsigned digit = 0;
        for (unsigned axis = 0; axis < 3; ++axis) digit |= unsigned(cell[axis] >= lo[axis] + half) << axis;
        return digit;
    }
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

/// A position in Directory::octants().
using OctantIndex = std::uint32_t;

/// An octant in a Directory.
struct Octant {
    Cell lo;                 ///< first cell on each axis
    unsigned level;          ///< the side is 2^(21 - level) cells
    OctantIndex parent;      ///< the root is its own parent
    OctantIndex next;        ///< first octant after the subtree
    std::uint32_t children;  ///< row of the child table; no_children for a leaf

    static constexpr std::uint32_t no_children = ~std::uint32_t(0);
    bool leaf() const { return children == no_children; }
    OctalCode code() const { return OctalCode::from_cell({lo[0], lo[1], lo[2]}, level); }

    bool touches(const CellBox& box) const {
        bool touched = true;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t last = lo[axis] + ((cells_per_axis >> level) - 1);
            touched &= box.lo[axis] <= last && box.hi[axis] >= lo[axis] + (planted(Fault::octant_border_open) ? 1 : 0);
        }
        return touched;
    }
};

class OCTOPAIR_PRIVATE_EXPORT Directory {
public:
    /// Makes the root alone.
    Directory() : Directory({}, {0}) {}
    /// Makes the octants of `shape`, which is the shape of the whole tree.
    /// Throws: Error{resource_limit} for 2^26 - 1 or more octants.
    Directory(const Space& space, const SplitFlags& shape);

    std::span<const Octant> octants() const { return octants_; }
    OctantIndex child(const Octant& octant, unsigned digit) const { return children_[octant.children][digit]; }

    /// Index and level of a leaf.
    class Leaf {
    public:
        Leaf() = default;
        OctantIndex octant() const { return element_ & max_octants; }
        unsigned level() const { return element_ >> octant_bits; }

        /// Returns index and level in one number, as in LeafTable.
        std::uint32_t element() const { return element_; }
        explicit Leaf(std::uint32_t element) : element_(element) {}

    private:
        std::uint32_t element_;
    };
    /// The tables in which leaf() looks up cells, for SIMD versions of leaf(). The comment at first_element() explains the tables.
    struct LeafTable {
        const std::uint32_t* elements;
        std::size_t size;
        std::array<std::uint32_t, 3> sizes;
        unsigned shift;       ///< an octant of the first table has 2^shift cells on each axis
        unsigned last_shift;  ///< the finest leaf has 2^last_shift cells on each axis

        /// Returns the number of octree levels that a table covers if its octant has 2^`of` cells on each axis.
        unsigned levels_below(unsigned of) const { return std::min(of - last_shift, max_levels); }
        static constexpr unsigned max_levels = 3;
    };
    LeafTable leaf_table() const { return {table_.data(), table_.size(), table_size_, table_shift_, last_shift_}; }
    static constexpr unsigned octant_bits = 26;
    static constexpr std::uint32_t max_octants = (std::uint32_t(1) << octant_bits) - 1;
    static constexpr std::uint32_t further = (deepest + 1) << octant_bits;
    /// Returns the leaf that holds `cell`.
    Leaf leaf(const Cell& cell) const {
        unsigned shift = table_shift_;
        std::uint32_t found = first_element(cell);
        while (found >= further) found = further_element(found, cell, shift);
        return Leaf(found);
    }
    /// Sets leaves[i] to the leaf that boxes[i] begins in.
    void leaves(std::span<const CellBox> boxes, std::span<Leaf> leaves) const;
    /// Returns the octant of `level` that holds the leaf, or the leaf itself if its level is not deeper.
    OctantIndex at_most(const Leaf& leaf, unsigned level) const {
        OctantIndex octant = leaf.octant();
        for (unsigned above = leaf.level(); above > level; --above) octant = octants_[octant].parent;
        return octant;
    }

private:
    OctantIndex append(const OctantCube& cube, OctantIndex parent, const SplitFlags& shape);
    void make_table(const Space& space);
    struct Table;
    void fill_table(OctantIndex index, const Table& table);
    std::uint32_t add_table(OctantIndex index, const Table& table);

    std::vector<Octant> octants_;
    std::vector<std::array<OctantIndex, 8>> children_;

    // Lookup from cells to leaves. The first table has the octants of one level, row-major. An octant that is divided further
    // has a table of the next three levels, and so on; no table has levels below the finest leaf. An element is a leaf with
    // its level, or `further` plus the position where the octant's table begins.
    std::uint32_t first_element(const Cell& cell) const {
        const std::uint32_t x = cell[0] >> table_shift_, y = cell[1] >> table_shift_, z = cell[2] >> table_shift_;
        return table_[(z * table_size_[1] + y) * table_size_[0] + x];
    }
    /// Returns the element of `cell` in the table that `element` refers to. Lowers `shift` to that table: its octants have
    /// 2^shift cells on each axis.
    std::uint32_t further_element(std::uint32_t element, const Cell& cell, unsigned& shift) const {
        const unsigned levels = leaf_table().levels_below(shift);
        const unsigned mask = (1u << levels) - 1;
        shift -= levels;
        const std::uint32_t x = cell[0] >> shift & mask, y = cell[1] >> shift & mask, z = cell[2] >> shift & mask;
        return table_[element - further + ((z << levels | y) << levels | x)];
    }
    std::vector<std::uint32_t> table_;
    std::array<std::uint32_t, 3> table_size_ = {1, 1, 1};
    unsigned table_shift_ = deepest, last_shift_ = deepest;
};

}  // namespace octopair
