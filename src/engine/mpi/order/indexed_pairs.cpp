#include "engine/mpi/order/indexed_pairs.hpp"

#include <algorithm>
#include <utility>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/even_runs.hpp"

namespace octopair {

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
