#include "engine/mpi/partition/regional_owners.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

namespace {

/// Gives octants of ranks with too much work to the ranks with least work.
void balance(std::vector<std::uint32_t>& owners, std::span<const std::uint64_t> work, unsigned ranks) {
    constexpr double most_over_mean = 1.03;
    std::vector<std::uint64_t> loads(ranks, 0);
    for (std::size_t octant = 0; octant < work.size(); ++octant) loads[owners[octant]] += work[octant];
    const double mean = double(std::accumulate(loads.begin(), loads.end(), std::uint64_t(0))) / double(ranks);
    const auto limit = std::uint64_t(mean * most_over_mean);
    for (std::size_t octant = 0; octant < work.size(); ++octant) {
        const std::uint32_t owner = owners[octant];
        if (loads[owner] <= limit) continue;
        const auto least = std::ranges::min_element(loads);
        if (*least + work[octant] > limit) continue;
        loads[owner] -= work[octant];
        *least += work[octant];
        owners[octant] = std::uint32_t(least - loads.begin());
    }
}

}  // namespace

std::optional<OctantOwners> regional_owners(Communicator& comm, const OctantLoads& loads) {
    // If objects are near each other, few ranks have entries in an octant. Otherwise almost all ranks have some.
    constexpr std::uint64_t part_of_ranks = 4;
    const unsigned ranks = comm.size();
    const auto has_entries = [](std::uint32_t entries) { return entries > 0; };
    const auto filled = std::uint64_t(std::ranges::count_if(loads.own, has_entries));
    const auto not_empty = std::uint64_t(std::ranges::count_if(loads.work, [](std::uint64_t work) { return work > 0; }));
    const std::uint64_t most = not_empty + not_empty * (ranks - 1) / part_of_ranks;
    if (comm.sum(filled) > most) return {};
    count_path(Path::ranks_regional);
    // The rank with most entries of an octant, and among equals the first one.
    std::vector<std::uint64_t> largest;
    Agreement agreement(comm);
    agreement.together([&] {
        for (const std::uint32_t entries : loads.own)
            largest.push_back(std::uint64_t(entries) << 32 | (ranks - 1 - comm.rank()));
    });
    comm.take_largest(largest);
    std::optional<OctantOwners> result;
    agreement.together([&] {
        std::vector<std::uint32_t> owners;
        for (const std::uint64_t most_entries : largest)
            owners.push_back(ranks - 1 - std::uint32_t(most_entries & ~std::uint32_t(0)));
        balance(owners, loads.work, ranks);
        result.emplace(std::move(owners), ranks);
    });
    return result;
}

}  // namespace octopair
