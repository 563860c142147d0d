// MutableOctree: a linear octree whose entries can be inserted, erased and searched.
//
// Invariants
//   The octants are those of the LinearOctree from which the MutableOctree was built.
//   A leaf is cut further into a grid of cells, so that a cell holds a few entries.
//   A unit is a cell, a leaf or an inner octant that keeps entries. A leaf keeps the boxes that would touch more than eight
//   of its cells. An inner octant keeps the boxes that are too large for a leaf, as in the LinearOctree.
//   The units with an entry of a box tile the cells that the box touches.
//   Two boxes are reported only in the unit that holds the low corner of their intersection, so once.
//
// Entries hold boxes in 8 bits a number, relative to the unit, in blocks of 12, so a search reads only a few cache lines.
// Boxes that overlap in 8 bits may not overlap exactly: the caller must test them.
//
// Many changes at once are made unit by unit. list() lists the units that a change visits, and run() makes visits. Visits of
// one unit must run in the order of their changes; visits of different units may run concurrently. Searches then find what
// they would find if the changes were made one after another.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/objects.hpp"
#include "octree/dynamic/leaf_grid.hpp"
#include "octree/dynamic/small_block.hpp"
#include "octree/dynamic/unit_blocks.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

class Executor;
class LinearOctree;

/// An object that is added, moved or removed.
struct OctreeChange {
    std::uint32_t object;
    bool existed, exists;   ///< before and after the change
    CellBox before, after;  ///< the object's box before (if it existed) and after (if it exists)
};

/// Bits of UnitVisit::around and Hit::around: whether a search looks for boxes that overlap the object's box before or after the change.
enum : std::uint8_t { around_before = 1, around_after = 2 };

/// Operations of a change in a unit: a search, then the removal of an entry, then the addition of an entry.
struct UnitVisit {
    std::uint32_t unit;
    std::uint32_t change;  ///< number of the change
    std::uint32_t object;
    std::uint8_t around;  ///< around_before, around_after or both; 0: no search
    bool take, put;       ///< whether an entry is removed, and added
    SmallBox wanted;      ///< box of the search
    SmallBox entry;       ///< box of the entry that is added
};

/// An object that the search of a visit found.
struct Hit {
    std::uint32_t change;
    std::uint32_t object;
    std::uint8_t around;
};

template <typename Visitor>
class NearestSearch;

class MutableOctree {
public:
    /// A function that sets the bounds of entries. The caller of the function has set their objects.
    using LoadBounds = std::function<void(std::span<Entry>)>;
    /// Replaces the contents by the entries of `octree`. `load_bounds` must give the bounds that `octree` was built with; it
    /// is called concurrently.
    /// Throws: Error{cancelled}; the octree is then empty.
    void build(const LinearOctree& octree, const LoadBounds& load_bounds, Executor& executor,
               const std::stop_token& stop);
    /// Removes all octants and entries, and keeps the memory.
    void clear();
    /// Removes all octants and entries, and frees the memory.
    void release();

    const Space& space() const { return space_; }
    /// Adds an object. `box`: cells of space().
    /// Requires: the octree does not hold the object.
    void insert(std::uint32_t object, const CellBox& box);
    /// Removes an object. `box`: the box with which the object was inserted.
    void erase(std::uint32_t object, const CellBox& box);
    /// Appends the objects whose cells overlap `box`, each once, in no particular order. May also append objects that are only near `box`.
    void search(const CellBox& box, std::vector<std::uint32_t>& found) const;
    bool empty() const { return grids_.empty(); }
    /// Returns the unit of a leaf that holds a cell. Units of near numbers are near in memory. Requires: the octree is not empty.
    Unit unit_at(const Cell& cell) const;

    /// The visits of units that some changes need.
    struct Visits {
        std::vector<UnitVisit> visits;
        std::vector<OctantIndex> first_used;  ///< octants whose own unit gets its first entry
        void clear() {
            visits.clear();
            first_used.clear();
        }
    };
    /// Appends the visits of change `number`. Returns false, and appends no visits, if there are too many. The change must then
    /// be made with search(), erase() and insert(), before all changes that are listed.
    bool list(const OctreeChange& change, std::uint32_t number, Visits& out) const;
    /// Prefetches data for list() of a change.
    void prefetch(const OctreeChange& change) const;
    /// Marks the own units of `octants` as used, so that searches visit these units. Call it with all of Visits::first_used, and then list
    /// all changes again.
    void use(std::span<const OctantIndex> octants);
    std::uint32_t units() const { return units_.units(); }
    /// Makes room for visits that add `puts` entries.
    void reserve(std::uint64_t puts) { units_.reserve(puts); }
    /// Runs visits in `order`, and appends the objects that their searches find, except the changed object itself. Returns the
    /// number of visits that were run: fewer than `order` has if there are very many hits.
    /// Requires: an element of `order` has the index of a visit in its low 32 bits, and the visit's unit in its high 32 bits.
    std::size_t run(std::span<const UnitVisit> visits, std::span<const std::uint64_t> order, std::vector<Hit>& hits);

private:
    template <typename Visitor>
    friend class NearestSearch;  // nearest_search.hpp
    struct Work;

    void add_range(const LinearOctree& octree, OctantIndex begin, OctantIndex end, const LoadBounds& load_bounds);

    template <typename Visit>
    void for_each_unit_of(OctantIndex octant, const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_home_unit(const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_octant_below(OctantIndex octant, const CellBox& box, Visit&& visit) const;
    template <typename Visit>
    void for_each_touched_octant(const CellBox& box, Visit&& visit) const;
    bool list(const Work& work, Visits& out) const;
    void list_octant(OctantIndex octant, const Work& work, Visits& out) const;

    Space space_;
    Directory directory_;
    std::vector<LeafGrid> grids_;  // by octant
    UnitBlocks units_;
    bool inner_used_ = false;  // true if the own unit of an inner octant may hold entries
};

}  // namespace octopair
