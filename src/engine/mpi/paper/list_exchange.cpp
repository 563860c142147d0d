#include "engine/mpi/paper/list_exchange.hpp"

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/cost_meter.hpp"

namespace octopair {

namespace {

/// How many values of a list go from a rank, and where to.
struct ToldSizes {
    std::uint64_t to, values;
};

Exchange exchange_of(const std::vector<ToldSizes>& told, unsigned rank) {
    Exchange exchange{RankCounts(told.size(), 0), RankCounts(told.size(), 0)};
    if (told[rank].to != rank) exchange.sent[told[rank].to] = told[rank].values;
    for (unsigned from = 0; from < told.size(); ++from) {
        if (from != rank && told[from].to == rank) exchange.received[from] = told[from].values;
    }
    return exchange;
}

}  // namespace

std::vector<SortedList> ListExchange::bring(const SortedList& own, unsigned to) {
    const unsigned rank = comm_.rank();
    const std::size_t octants = own.home_begins.size();
    std::vector<ToldSizes> told = comm_.all_gather(ToldSizes{to, own.entries.size()});
    const Exchange entries = exchange_of(told, rank);
    for (ToldSizes& one : told) one.values = 2 * octants;
    const Exchange counts = exchange_of(told, rank);
    Agreement(comm_).together([&] {
        const Metered metered(comm_, costs_.pack);
        if (to != rank) pack(own);
        received_.resize_discard(entries.incoming());
        received_counts_.resize_discard(counts.incoming());
    });
    comm_.exchange(own.entries.data(), received_.data(), entries);
    comm_.exchange(sent_counts_.data(), received_counts_.data(), counts);
    std::vector<SortedList> lists;
    Agreement(comm_).together([&] {
        const Metered metered(comm_, costs_.merge);
        lists = unpack(octants);
    });
    return lists;
}

void ListExchange::pack(const SortedList& list) {
    const std::size_t octants = list.home_begins.size();
    sent_counts_.resize_discard(2 * octants);
    for (std::size_t octant = 0; octant < octants; ++octant) {
        const std::uint64_t end = octant + 1 < octants ? list.home_begins[octant + 1] : list.entries.size();
        sent_counts_[2 * octant] = std::uint32_t(list.ghost_begins[octant] - list.home_begins[octant]);
        sent_counts_[2 * octant + 1] = std::uint32_t(end - list.ghost_begins[octant]);
    }
}

std::vector<SortedList> ListExchange::unpack(std::size_t octants) {
    begins_.resize_discard(received_counts_.size());
    std::vector<SortedList> lists;
    std::size_t begin = 0;  // of the entries that follow
    for (std::size_t i = 0; i < received_counts_.size(); i += 2 * octants) {
        const auto homes = begins_.span().subspan(i, octants), ghosts = begins_.span().subspan(i + octants, octants);
        std::uint64_t at = 0;
        for (std::size_t octant = 0; octant < octants; ++octant) {
            homes[octant] = at;
            at += received_counts_[i + 2 * octant];
            ghosts[octant] = at;
            at += received_counts_[i + 2 * octant + 1];
        }
        lists.push_back({received_.span().subspan(begin, std::size_t(at)), homes, ghosts});
        begin += std::size_t(at);
    }
    return lists;
}

}  // namespace octopair
