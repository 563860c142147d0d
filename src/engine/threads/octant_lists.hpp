// OctantLists: the contents of Octants, copied from a linear octree.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "base/private_export.hpp"
#include "octopair/octants.hpp"
#include "parallel/team.hpp"

namespace octopair {

namespace detail {

struct OctantLists {
    std::vector<OctantSummary> octants;
    std::vector<std::uint64_t> begins;   ///< by octant: position of its first object in `objects`; then their number
    std::vector<std::uint32_t> objects;  ///< objects of all octants
    std::vector<std::uint32_t> homes;    ///< by object: its home, or Octants::no_octant
    Box3d space;
};

}  // namespace detail

/// The numbers of objects in a list of octants.
struct ObjectNumbers {
    std::span<const std::uint32_t> numbers;  ///< by position in the boxes; empty: the position itself
    std::uint64_t limit;                     ///< every number is smaller
};

/// Makes the list of list_octants(). Requires: the arguments are valid, except boxes and paddings.
/// Throws: as list_octants() does.
OCTOPAIR_PRIVATE_EXPORT Octants list_octants(const Objects& objects, double margin, const ObjectNumbers& numbers,
                                             Team& team, const std::stop_token& stop);

}  // namespace octopair
