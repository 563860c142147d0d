// OctantOwners: assignment of the octants that all ranks store to ranks.
//
// Such an octant may be divided further in the whole octree. Then its owner owns all of its descendants.
//
// Invariants 1. Each rank owns one run of the pre-order of the octree. A run may be empty.
//            2. An object belongs to each rank that owns an octant with an entry of the object.
//            3. If an entry is kept in an inner octant, the object also belongs to each rank that owns a descendant that the
//               box touches. So a rank has all objects that are handed down to its octants.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/mpi/partition/shared_top.hpp"
#include "octree/build/encoder.hpp"
#include "octree/plan/directory.hpp"

namespace octopair {

class OctantOwners {
public:
    /// Divides the octants of `top` into one run for each rank, so that the run with most work has as little work as possible. The
    /// result depends only on the arguments. `directory`: of the octants of `top`; borrowed. `entries`: number of entries of each
    /// octant, summed over all ranks, in any unit.
    OctantOwners(const SharedTop& top, const Directory& directory, std::span<const std::uint32_t> entries,
                 unsigned ranks);

    unsigned ranks() const { return unsigned(begins_.size() - 1); }
    OctantIndex begin(unsigned rank) const { return OctantIndex(begins_[rank]); }
    OctantIndex end(unsigned rank) const { return OctantIndex(begins_[rank + 1]); }
    unsigned owner(OctantIndex octant) const { return owners_[octant]; }

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
    /// Requires: the box extends beyond `home`.
    template <typename Place>
    void for_each_owner(const CellBox& box, Directory::Leaf home, Place&& place) const {
        for_each_octant_of(box, directory_, home,
                           [&](OctantIndex octant, unsigned) { add_owners(box, octant, place); });
    }

private:
    /// Calls place(rank) for the owner of `octant`, and for the owner of each descendant that the box touches.
    /// Requires: the box touches `octant`.
    template <typename Place>
    void add_owners(const CellBox& box, OctantIndex octant, Place& place) const {
        const Octant& parent = directory_.octants()[octant];
        place(owner(octant));
        if (owner(parent.next - 1) == owner(octant)) return;
        for (unsigned digit = 0; digit < 8; ++digit) {
            const OctantIndex child = directory_.child(parent, digit);
            if (directory_.octants()[child].touches(box)) add_owners(box, child, place);
        }
    }

    const Directory& directory_;
    std::vector<std::size_t> begins_;
    std::vector<std::uint32_t> owners_;
};

}  // namespace octopair
