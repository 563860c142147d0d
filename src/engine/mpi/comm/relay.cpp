#include "engine/mpi/comm/relay.hpp"

#include <algorithm>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

void Relay::forward(unsigned from, const Give& give) {
    if (from == 0) {
        agreement_.together([&] {
            if (comm_.rank() == 0) give(take_);
        });
    } else if (comm_.rank() == from) {
        send(from, give);
    } else {
        receive(from);
    }
}

void Relay::send(unsigned from, const Give& give) {
    bool thrown_on_all = false;  // true during send_held(), whose exceptions are already thrown on all ranks
    const auto send_batch = [&] {
        thrown_on_all = true;
        send_held(from);
        thrown_on_all = false;
    };
    try {
        give([&](std::span<const Pair> pairs) {
            while (!pairs.empty()) {
                const auto some = pairs.first(std::min(pairs.size(), tuning().ranks.relayed - held_.size()));
                held_.insert(held_.end(), some.begin(), some.end());
                pairs = pairs.subspan(some.size());
                if (held_.size() == tuning().ranks.relayed) {
                    count_path(Path::relay_full);
                    send_batch();
                }
            }
        });
    } catch (...) {
        if (thrown_on_all) throw;
        agreement_.together([] { throw; });
    }
    if (!held_.empty()) send_held(from);
    send_held(from);
}

/// Sends the held pairs to rank 0. A batch of size 0 ends the transfer.
void Relay::send_held(unsigned from) {
    agreement_.together([] {});
    std::uint64_t size = held_.size();
    comm_.broadcast(std::span(&size, 1), from);
    if (size == 0) return;
    Exchange counts{RankCounts(comm_.size(), 0), RankCounts(comm_.size(), 0)};
    counts.sent[0] = size;
    comm_.exchange<Pair>(held_.data(), nullptr, counts);
    held_.clear();
}

void Relay::receive(unsigned from) {
    const bool first = comm_.rank() == 0;
    for (std::uint64_t size = 0;;) {
        agreement_.together([&] {
            if (!first) return;
            if (size > 0) take_(received_.span().first(std::size_t(size)));
            received_.resize_discard(tuning().ranks.relayed);
        });
        comm_.broadcast(std::span(&size, 1), from);
        if (size == 0) return;
        if (!first) continue;
        Exchange counts{RankCounts(comm_.size(), 0), RankCounts(comm_.size(), 0)};
        counts.received[from] = size;
        comm_.exchange<Pair>(nullptr, received_.data(), counts);
    }
}

}  // namespace octopair
