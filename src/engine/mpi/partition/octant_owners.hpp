// OctantOwners: assignment of the octants that all ranks store to ranks.
//
// Such an octant may be divided further in the whole octree. Then its owner owns all of its descendants.
//
// Invariants 1. Each rank owns one run of the pre-order of the octree (a run may be empty), unless the owners are given one by one.
//            2. An object, or an entry of it, belongs to each rank that owns an octant with an entry of the object.
//            3. If an entry is kept in an inner octant, it also belongs to each rank that owns a descendant that the box touches.
//               So a rank has all entries that are handed down to its octants.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/build/encoder.hpp"
#include "octree/plan/directory.hpp"

namespace octopair {

class OctantOwners {
public:
    OctantOwners() = default;
    /// Divides the octants into one run for each rank, so that the run with most work has as little work as possible. The result depends
    /// only on the arguments. `work`: estimated work in each octant that all ranks store.
    OctantOwners(std::span<const std::uint64_t> work, unsigned ranks);

    /// `owners`: rank that owns each octant.
    OctantOwners(std::vector<std::uint32_t> owners, unsigned ranks);

    unsigned ranks() const { return unsigned(begins_.size() - 1); }
    unsigned owner(OctantIndex octant) const { return owners_[octant]; }
    /// Returns the octants that a rank owns, ascending.
    std::span<const OctantIndex> octants_of(unsigned rank) const {
        return std::span(octants_).subspan(begins_[rank], begins_[rank + 1] - begins_[rank]);
    }
    /// Returns the begin and the end of a rank's run. Requires: each rank owns one run.
    OctantIndex begin(unsigned rank) const { return OctantIndex(begins_[rank]); }
    OctantIndex end(unsigned rank) const { return OctantIndex(begins_[rank + 1]); }
    /// True if each rank owns one run, and these runs are in the order of ranks.
    bool in_runs() const { return std::ranges::is_sorted(owners_); }

    /// Range of the pre-order, from `first` to `last`, that has all octants that a box belongs to.
    struct Reach {
        OctantIndex first = 0, last = 0;
        bool only = false;  ///< the box belongs to no octants but `first` and `last`
    };
    /// Returns the reach of a box. `home`, `end`: the leaves of its low and its high corner. A cell that is not before another
    /// cell on any axis is not before it in pre-order, so the corners bound the range.
    static Reach reach(const CellBox& box, const Directory& directory, Directory::Leaf home, Directory::Leaf end) {
        const unsigned natural = natural_level(box), level = home.level();
        const unsigned crossed = crossed_axes(box, level);
        const bool only = level == end.level() && level <= natural && (crossed & (crossed - 1)) == 0;
        return {directory.at_most(home, natural), end.octant(), only};
    }
    bool is_shared(const Reach& reach) const { return owner(reach.first) != owner(reach.last); }

    /// Calls place(rank) for each rank that a box belongs to, possibly more than once. `home`: the leaf of its low corner.
    /// `directory`: of the octants that all ranks store. Requires: the box extends beyond `home`.
    template <typename Place>
    void for_each_owner(const CellBox& box, const Directory& directory, Directory::Leaf home, Place&& place) const {
        for_each_octant_of(box, directory, home,
                           [&](OctantIndex octant, unsigned) { for_each_owner_below(box, directory, octant, place); });
    }

    /// Calls place(rank) for the owner of `octant`, and for the owner of each descendant that the box touches, possibly more than once.
    /// Requires: the box touches `octant`.
    template <typename Place>
    void for_each_owner_below(const CellBox& box, const Directory& directory, OctantIndex octant, Place& place) const {
        const Octant& parent = directory.octants()[octant];
        place(owner(octant));
        if (owner(parent.next - 1) == owner(octant)) return;
        for (unsigned digit = 0; digit < 8; ++digit) {
            const OctantIndex child = directory.child(parent, digit);
            if (directory.octants()[child].touches(box)) for_each_owner_below(box, directory, child, place);
        }
    }

private:
    std::vector<std::size_t>
        begins_;  // by rank: place in octants_ of the first octant that it owns; then the number of octants
    std::vector<std::uint32_t> owners_;  // by octant
    std::vector<OctantIndex> octants_;   // by owner, then ascending
};

}  // namespace octopair
