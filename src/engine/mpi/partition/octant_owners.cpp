#include "engine/mpi/partition/octant_owners.hpp"

#include <algorithm>

#include "base/tuning.hpp"
#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

namespace {

/// Cost of the work on an entry apart from box tests and pairs, in box tests and in pairs: this work takes as long as 64 box tests, or as
/// 8 pairs. Measured.
constexpr double tests_per_entry_cost = 64;
constexpr double pairs_per_entry_cost = 8;

/// Returns the estimated work in each octant. One unit of work is an entry that no other entry is tested against. A sweep tests each entry
/// against the entries that overlap it on the sweep's axis. The rank that owns an octant divides it until each entry has few such tests.
std::vector<std::uint64_t> work_of(const SharedTop& top, std::span<const std::uint32_t> entries) {
    std::vector<std::uint64_t> work(entries.size());
    for (std::size_t octant = 0; octant < work.size(); ++octant) {
        const SharedTop::SharedOctant& shared = top.octants()[octant];
        const double all = double(entries[octant]);
        double tests = all * shared.shortest;
        if (shared.left) tests = std::min(tests, tuning().split.max_tests_per_object);
        const double pairs = all / 2 * shared.overlap;
        work[octant] = std::uint64_t(all * (1 + tests / tests_per_entry_cost + pairs / pairs_per_entry_cost));
    }
    return work;
}

}  // namespace

OctantOwners::OctantOwners(const SharedTop& top, const Directory& directory, std::span<const std::uint32_t> entries,
                           unsigned ranks)
    : directory_(directory), begins_(least_cuts(work_of(top, entries), ranks)), owners_(entries.size()) {
    for (unsigned rank = 0; rank < ranks; ++rank) {
        std::fill(owners_.begin() + begin(rank), owners_.begin() + end(rank), rank);
    }
}

}  // namespace octopair
