#include "engine/mpi/entries/object_fetch.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

namespace {

ObjectArrays arrays_like(const SetSlice& slice, std::size_t objects) {
    ObjectArrays arrays;
    arrays.wide = slice.call.wide[slice.set];
    arrays.padded = slice.call.padded[slice.set];
    arrays.resize(objects);
    return arrays;
}

}  // namespace

ObjectArrays fetch_objects(Communicator& comm, const SetSlice& slice, std::span<const std::uint32_t> positions) {
    const std::vector<std::uint64_t>& starts = slice.call.starts[slice.set];
    RankCounts from_each(comm.size(), 0);
    auto begin = positions.begin();
    for (unsigned rank = 0; rank < comm.size(); ++rank) {
        const auto end = std::lower_bound(begin, positions.end(), starts[rank + 1]);
        from_each[rank] = std::uint64_t(end - begin);
        begin = end;
    }
    const Exchange asked = comm.plan_exchange(std::move(from_each));
    std::vector<std::uint32_t> asked_for;
    ObjectArrays in, out;
    Agreement agreement(comm);
    agreement.together([&] {
        asked_for.resize(asked.incoming());
        in = arrays_like(slice, positions.size());
        std::ranges::copy(positions, in.positions.data());
    });
    comm.exchange(positions.data(), asked_for.data(), asked);
    agreement.together([&] {
        out = arrays_like(slice, asked_for.size());
        out.copying(slice.objects, [&](const auto& copy) {
            for (std::size_t i = 0; i < asked_for.size(); ++i)
                copy(i, std::size_t(asked_for[i] - slice.call.begins[slice.set]));
        });
    });
    exchange_objects(comm, out.view(), in, {asked.received, asked.sent});
    return in;
}

}  // namespace octopair
