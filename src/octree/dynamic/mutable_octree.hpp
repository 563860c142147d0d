// MutableOctree: a linear octree whose entries can be taken out, put in and searched for.
//
// Invariants
//   The octants are those of the LinearOctree that it was built from. A leaf is cut further into a grid of cells, so that
//   one holds a few entries; a box that would touch more than eight cells of a leaf is kept by the leaf itself, and one
//   too large for a leaf by the octant above, as there. What keeps entries (a cell, a leaf, an octant) is a unit.
//   A box has an entry in each unit that it touches of those that may keep it; these tile it.
//   Two boxes are reported to each other in the unit that holds the low corner of their intersection, so once.
//
// Entries hold their boxes in 8 bits a number, relative to their unit, and stand in blocks of 12: what a search reads is a
// few lines of memory. What overlaps here may not overlap in truth: who searches decides.
//
// Many changes at once are made unit by unit: list() tells which units a change visits, and run() makes visits. Those of
// one unit must be run in the order of their changes; those of different units may be at the same time. What a search
// finds is then what it would if the changes were made one after the other.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "octree/directory.hpp"
#include "octree/dynamic/leaf_grid.hpp"
#include "octree/dynamic/nearest_visitor.hpp"
#include "octree/dynamic/small_block.hpp"
#include "octree/dynamic/unit_blocks.hpp"
#include "octree/space.hpp"

namespace octopair {

class LinearOctree;

/// An object that comes, moves or goes.
struct OctreeChange {
    std::uint32_t object;
    bool existed, exists;
    CellBox before, after;  ///< where it did, and does
};

/// Which of the two places of an object a search is about, as bits.
enum : std::uint8_t { around_before = 1, around_after = 2 };

/// What a change has to do in a unit.
struct UnitVisit {
    std::uint32_t unit;
    std::uint32_t change;  ///< its number
    std::uint32_t object;
    std::uint8_t around;  ///< what is searched, at once; 0 for none
    bool take, put;       ///< after the search, in this order
    SmallBox wanted;      ///< the box of the search
    SmallBox entry;       ///< what is put
};

struct Hit {
    std::uint32_t change;
    std::uint32_t object;
    std::uint8_t around;
};

class MutableOctree {
public:
    /// Replaces what it held by the entries of `octree`. Throws Error{cancelled}, and is empty then.
    void build(const LinearOctree& octree, const std::stop_token& stop);
    /// Forgets everything, but keeps its memory.
    void clear();
    /// And gives it back.
    void release();

    const Space& space() const { return space_; }
    /// Of its boxes: cells of space(). An object is in here once.
    void insert(std::uint32_t object, const CellBox& box);
    /// `box` as when it was inserted.
    void erase(std::uint32_t object, const CellBox& box);
    /// Appends the objects whose boxes' cells overlap those of `box`, each once, in no order.
    void search(const CellBox& box, std::vector<std::uint32_t>& found) const;
    /// Hands a visitor what is near enough, what is near first.
    void search(NearestVisitor& visitor) const;

    /// The visits of some changes.
    struct Visits {
        std::vector<UnitVisit> visits;
        std::vector<OctantIndex> first_used;  ///< octants that will keep their first entry
        void clear() {
            visits.clear();
            first_used.clear();
        }
    };
    /// Appends what a change has to visit; false, and no visits, if these are too many: it is then to be made with
    /// search(), erase() and insert() before all that are listed.
    bool list(const OctreeChange& change, std::uint32_t number, Visits& out) const;
    /// For a change that is listed soon.
    void prefetch(const OctreeChange& change) const;
    /// To be called with what list() found to be used first, before all is listed again: searches visit these as well.
    void use(std::span<const OctantIndex> octants);
    std::uint32_t units() const { return units_.units(); }
    /// Room for visits that put so many entries.
    void reserve(std::uint64_t puts) { units_.reserve(puts); }
    /// Makes those of `visits` that `order` names in its low 32 bits, and appends what their searches find beside the
    /// object itself. Returns how many it made, from the first: it stops where these have found very much.
    std::size_t run(std::span<const UnitVisit> visits, std::span<const std::uint64_t> order, std::vector<Hit>& hits);

private:
    /// A change's search, and which entries go with it.
    struct Work;

    template <typename Visit>
    void for_each_unit_of(OctantIndex octant, const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_home_unit(const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_octant_below(OctantIndex octant, const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_touched_octant(const CellBox& box, Visit&& visit) const;
    void visit_octant(OctantIndex octant, NearestVisitor& visitor) const;
    void visit_cells(const LeafGrid& leaf, const GridRange& range, NearestVisitor& visitor) const;
    void visit_unit(const Unit& unit, NearestVisitor& visitor) const;
    bool list(const Work& work, Visits& out) const;
    void list_octant(OctantIndex octant, const Work& work, Visits& out) const;

    Space space_;
    Directory directory_;
    std::vector<LeafGrid> grids_;  // of the octants
    UnitBlocks units_;
    bool inner_used_ = false;  // a grid that is inner is used
};

}  // namespace octopair
