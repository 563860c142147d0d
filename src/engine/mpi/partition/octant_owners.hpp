// OctantOwners: which rank owns which octants: the pre-order of the octree, cut into one run for each rank.
//
// A rank's run may be empty. An object belongs to every rank that owns an octant with an entry of it, and where it is kept
// in an octant above, to every rank that owns one of those below which it touches: so what is handed down to a rank's octants
// is there too.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/build/octants_of.hpp"
#include "octree/directory.hpp"

namespace octopair {

/// What there is to do in an octant: sums over its entries.
struct OctantLoad {
    std::uint64_t entries = 0;
    std::uint64_t extent = 0;  ///< in cells, on the axis on which a box is shortest

    void add(const CellBox& box) {
        ++entries;
        extent += std::min({box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]});
    }
    void multiply(std::uint64_t by) {
        entries *= by;
        extent *= by;
    }
    void add(const OctantLoad& other) {
        entries += other.entries;
        extent += other.extent;
    }
};

class OctantOwners {
public:
    /// Borrows the directory. Cuts it between octants so that each of `ranks` has about the same work with these loads, one
    /// for each octant: a function of these numbers alone.
    OctantOwners(const Directory& directory, std::span<const OctantLoad> loads, unsigned ranks);

    unsigned ranks() const { return unsigned(begins_.size() - 1); }
    OctantIndex begin(unsigned rank) const { return OctantIndex(begins_[rank]); }
    OctantIndex end(unsigned rank) const { return OctantIndex(begins_[rank + 1]); }
    unsigned owner(OctantIndex octant) const { return owners_[octant]; }

    /// All octants that a box belongs in lie, in pre-order, from the first of these to the last.
    struct Reach {
        OctantIndex first = 0, last = 0;
        bool only = false;  ///< there are no others
    };
    /// `home`, `end`: the leaves that the box begins and ends in. A cell that is on no axis before another does not come
    /// before it in pre-order.
    static Reach reach(const CellBox& box, const Directory& directory, Directory::Leaf home, Directory::Leaf end) {
        const unsigned natural = natural_level(box), level = home.level();
        const unsigned crossed = crossed_axes(box, level);
        const bool only = level == end.level() && level <= natural && (crossed & (crossed - 1)) == 0;
        return {directory.at_most(home, natural), end.octant(), only};
    }
    bool is_shared(const Reach& reach) const { return owner(reach.first) != owner(reach.last); }

    /// Calls place(rank) for each rank that a box belongs to which reaches beyond the leaf it begins in, `home`; a rank
    /// may come more than once.
    template <typename Place>
    void for_each_owner(const CellBox& box, Directory::Leaf home, Place&& place) const {
        for_each_octant_of(box, directory_, home, [&](OctantIndex octant, unsigned) { add_owners(box, octant, place); });
    }

private:
    /// Of an octant that the box touches, and all below.
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
