#include "engine/mpi/partition/octant_owners.hpp"

#include <algorithm>

#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

namespace {

/// Cost of all work on an entry besides the tests of the sweep, in box tests. Measured.
constexpr double tests_per_entry_cost = 64;

/// Returns the estimated work in each octant; 1: the cost of an entry without tests. A sweep tests each entry against the entries that overlap it on the
/// sweep's axis.
std::vector<std::uint64_t> work_of(const OctantLoads& loads) {
    std::vector<std::uint64_t> work(loads.entries.size());
    for (std::size_t octant = 0; octant < work.size(); ++octant) {
        const double entries = double(loads.entries[octant]);
        work[octant] = std::uint64_t(entries * (1 + entries * loads.extents[octant] / tests_per_entry_cost));
    }
    return work;
}

}  // namespace

OctantOwners::OctantOwners(const Directory& directory, const OctantLoads& loads, unsigned ranks)
    : directory_(directory), begins_(least_cuts(work_of(loads), ranks)), owners_(loads.entries.size()) {
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

}  // namespace octopair
