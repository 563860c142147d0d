#include "engine/mpi/order/index_order.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/tuning.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/partition/even_cuts.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// A sampled key of a rank, and the number of this rank's keys that the sampled key represents.
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

/// Collective. Returns the splitters of a sample sort over ranks: how many of this rank's ascending keys go to each rank, in order from
/// the first key. All ranks get about equally many keys. A rank gets no key less than a key of the rank before. Equal keys go to one rank.
/// Throws: as Agreement::together.
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

/// Returns the permutation that sorts `indices`.
std::vector<std::uint32_t> order_of(std::span<const std::uint64_t> indices) {
    std::vector<std::uint32_t> order(indices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return indices[i]; });
    return order;
}

/// Fills `to` with `objects` and their indices, permuted by `order`.
void arrange(const Objects& objects, std::span<const std::uint64_t> indices, std::span<const std::uint32_t> order,
             ObjectArrays& to) {
    to.resize(order.size());
    to.copying(objects, [&](const auto& copy) {
        for (std::size_t i = 0; i < order.size(); ++i) {
            copy(i, order[i]);
            to.indices[i] = indices[order[i]];
        }
    });
}

}  // namespace

/// Collective. Returns whether the ranks pass indices; the same on all ranks.
bool IndexOrder::are_given(const Objects& own, std::span<const std::uint64_t> indices) {
    Agreement(comm_).together([&] {
        if (!indices.empty() && indices.size() != own.size()) {
            throw Error(ErrorCode::bad_input,
                        std::to_string(indices.size()) + " indices for " + std::to_string(own.size()) + " objects");
        }
    });
    const bool given = comm_.sum(indices.size()) > 0;
    Agreement(comm_).together([&] {
        if (given && indices.size() != own.size()) {
            throw Error(ErrorCode::usage, "no indices are given, but other ranks give indices");
        }
    });
    return given;
}

void IndexOrder::take(const JointCall& call, unsigned set, const Objects& own, std::span<const std::uint64_t> indices) {
    ObjectArrays& arrays = arrays_[set];
    arrays = {.wide = call.wide[set], .padded = call.padded[set], .indexed = true};
    if (are_given(own, indices)) {
        exchange_and_sort(arrays, own, indices);
        objects_[set] = arrays.view();
        return;
    }
    Agreement(comm_).together([&] { arrays.indices.resize_discard(std::size_t(call.sizes[set])); });
    std::iota(arrays.indices.data(), arrays.indices.data() + arrays.indices.size(), call.begins[set]);
    objects_[set] = own;
}

void IndexOrder::exchange_and_sort(ObjectArrays& arrays, const Objects& own, std::span<const std::uint64_t> indices) {
    Agreement agreement(comm_);
    ObjectArrays sent{.wide = arrays.wide, .padded = arrays.padded, .indexed = true};
    ObjectArrays received{.wide = arrays.wide, .padded = arrays.padded, .indexed = true};
    agreement.together([&] { arrange(own, indices, order_of(indices), sent); });
    const Exchange counts = comm_.plan_exchange(even_runs(comm_, sent.indices.span()));
    agreement.together([&] { received.resize(counts.incoming()); });
    exchange_objects(comm_, sent.view(), received, counts);
    comm_.exchange(sent.indices.data(), received.indices.data(), counts);
    agreement.together([&] {
        arrange(received.view(), received.indices.span(), order_of(received.indices.span()), arrays);
        const auto all = arrays.indices.span();
        const auto twice = std::ranges::adjacent_find(all);
        if (twice != all.end()) {
            throw Error(ErrorCode::bad_input, "index " + std::to_string(*twice) + " is given to two objects");
        }
    });
}

void name_pairs(const PairList& found, std::span<const std::uint64_t> a_indices,
                std::span<const std::uint64_t> b_indices, std::vector<Pair64>& pairs) {
    pairs.reserve(std::size_t(found.size()));
    for (const auto chunk : found.chunks()) {
        for (const Pair& pair : chunk) pairs.push_back({a_indices[pair.a], b_indices[pair.b]});
    }
}

void sort_over_ranks(Communicator& comm, std::vector<Pair64>& pairs) {
    Agreement agreement(comm);
    std::vector<std::uint64_t> keys;
    agreement.together([&] {
        std::ranges::sort(pairs);
        keys.reserve(pairs.size());
        for (const Pair64& pair : pairs) keys.push_back(pair.a);
    });
    const Exchange counts = comm.plan_exchange(even_runs(comm, keys));
    std::vector<Pair64> received;
    agreement.together([&] { received.resize(counts.incoming()); });
    comm.exchange(pairs.data(), received.data(), counts);
    agreement.together([&] { std::ranges::sort(received); });
    pairs = std::move(received);
}

}  // namespace octopair
