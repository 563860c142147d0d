#include "engine/mpi/comm/relay.hpp"

#include <algorithm>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

void Relay::hand_on(unsigned from, const Give& give) {
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
    bool all_know = false;  // what is thrown meanwhile is thrown on all
    const auto pass_on = [&] {
        all_know = true;
        pass(from);
        all_know = false;
    };
    try {
        give([&](std::span<const Pair> pairs) {
            while (!pairs.empty()) {
                const auto some = pairs.first(std::min(pairs.size(), tuning().ranks.relayed - held_.size()));
                held_.insert(held_.end(), some.begin(), some.end());
                pairs = pairs.subspan(some.size());
                if (held_.size() == tuning().ranks.relayed) {
                    count_path(Path::relay_full);
                    pass_on();
                }
            }
        });
    } catch (...) {
        if (all_know) throw;
        agreement_.together([] { throw; });
    }
    if (!held_.empty()) pass(from);
    pass(from);
}

/// What is held; nothing says that no more will come.
void Relay::pass(unsigned from) {
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
