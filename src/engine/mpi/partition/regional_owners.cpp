#include "engine/mpi/partition/regional_owners.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
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
    // If objects are near each other, few ranks have much of an octant. Otherwise all ranks have about an equal part.
    const unsigned ranks = comm.size();
    std::uint64_t not_empty = 0;  // number of octants with entries
    std::uint64_t much = 0;       // number of octants of which this rank has at least half an equal part
    for (std::size_t octant = 0; octant < loads.all.size(); ++octant) {
        const std::uint64_t own = loads.own[octant], all = loads.all[octant];
        not_empty += all > 0 ? 1 : 0;
        much += all > 0 && own * 2 * ranks >= all ? 1 : 0;
    }
    if (comm.sum(much) > not_empty + not_empty * (ranks - 1) / tuning().ranks.part_of_ranks) return {};
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
        std::vector<std::uint32_t> owners(largest.size());
        std::ranges::transform(largest, owners.begin(), [=](std::uint64_t most_entries) {
            return ranks - 1 - std::uint32_t(most_entries & ~std::uint32_t(0));
        });
        balance(owners, loads.work, ranks);
        result.emplace(std::move(owners), ranks);
    });
    return result;
}

}  // namespace octopair
