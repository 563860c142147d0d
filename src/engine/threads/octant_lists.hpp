// OctantLists: the contents of Octants, copied from a linear octree.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/octants.hpp"
#include "parallel/team.hpp"

namespace octopair {

namespace detail {

struct OctantLists {
    std::vector<OctantSummary> octants;
    std::vector<std::uint64_t> begins;   ///< by octant: its begin in `objects`; at the end, the size of `objects`
    std::vector<std::uint32_t> objects;  ///< objects of all octants
    std::vector<std::uint32_t> homes;    ///< by object: its home, or Octants::no_octant
    Box3d space;
};

}  // namespace detail

/// The objects whose octants are listed.
struct ListedObjects {
    const Objects& objects;
    double margin;
    std::uint64_t numbers_end;                    ///< every number of an object is smaller
    std::span<const std::uint32_t> numbers = {};  ///< number of each object; empty: its position in `objects`
};

/// Builds the octree of the objects, and copies its octants. Requires: the margin and the number of paddings are valid.
/// Throws: as list_octants() does.
Octants copy_octants(const ListedObjects& listed, Team& team, const std::stop_token& stop);

}  // namespace octopair
