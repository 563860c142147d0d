#include "engine/mpi/partition/octant_owners.hpp"

#include <algorithm>

#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

namespace {

/// Cost of all work on an entry besides the tests of the sweep, in box tests. Measured.
constexpr double tests_per_entry_cost = 64;

/// Returns the estimated work in an octant, in box tests. A sweep tests each entry against the entries that overlap it on the
/// sweep's axis.
std::uint64_t work_of(const OctantLoad& load, unsigned level) {
    const double met = double(load.extent) / double(cells_per_axis >> level);
    return std::uint64_t(double(load.entries) * (tests_per_entry_cost + met));
}

std::vector<std::uint64_t> work_of(const Directory& directory, std::span<const OctantLoad> loads) {
    std::vector<std::uint64_t> work(loads.size());
    for (std::size_t octant = 0; octant < work.size(); ++octant)
        work[octant] = work_of(loads[octant], directory.octants()[octant].level);
    return work;
}

}  // namespace

OctantOwners::OctantOwners(const Directory& directory, std::span<const OctantLoad> loads, unsigned ranks)
    : directory_(directory), begins_(least_cuts(work_of(directory, loads), ranks)), owners_(loads.size()) {
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

}  // namespace octopair
