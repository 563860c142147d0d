#include "engine/mpi/order/even_runs.hpp"

#include <algorithm>
#include <vector>

#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/partition/even_cuts.hpp"

namespace octopair {

namespace {

/// A sampled key, and the number of keys of its rank that it represents.
struct SampledKey {
    std::uint64_t key, weight;
};

std::vector<SampledKey> sample_of(std::span<const std::uint64_t> keys) {
    std::vector<SampledKey> samples(std::min(keys.size(), tuning().ranks.key_samples));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::size_t begin = i * keys.size() / samples.size(), end = (i + 1) * keys.size() / samples.size();
        samples[i] = {keys[begin], end - begin};
    }
    return samples;
}

}  // namespace

RankCounts even_runs(Communicator& comm, std::span<const std::uint64_t> keys) {
    Agreement agreement(comm);
    std::vector<SampledKey> own;
    agreement.together([&] { own = sample_of(keys); });
    std::vector<SampledKey> samples = comm.all_gather(std::span<const SampledKey>(own)).values;
    RankCounts runs;
    agreement.together([&] {
        std::ranges::sort(samples, {}, &SampledKey::key);
        std::vector<std::uint64_t> weights(samples.size());
        std::ranges::transform(samples, weights.begin(), &SampledKey::weight);
        std::size_t begin = 0;
        const std::vector<std::size_t> cuts = even_cuts(weights, comm.size());
        for (std::size_t rank = 1; rank <= comm.size(); ++rank) {
            const auto end =
                cuts[rank] == samples.size() ? keys.end() : std::ranges::lower_bound(keys, samples[cuts[rank]].key);
            runs.push_back(std::size_t(end - keys.begin()) - begin);
            begin += std::size_t(runs.back());
        }
    });
    return runs;
}

}  // namespace octopair
