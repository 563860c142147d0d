#include "engine/mpi/paper/rank_lists.hpp"

#include <utility>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/cost_meter.hpp"

namespace octopair {

namespace {

/// Transfer of a rank's list: receiving rank and number of values.
struct ListTransfer {
    std::uint64_t to, values;
};

Exchange exchange_of(const std::vector<ListTransfer>& transfers, unsigned rank) {
    Exchange exchange{RankCounts(transfers.size(), 0), RankCounts(transfers.size(), 0)};
    if (transfers[rank].to != rank) exchange.sent[transfers[rank].to] = transfers[rank].values;
    for (unsigned from = 0; from < transfers.size(); ++from) {
        if (from != rank && transfers[from].to == rank) exchange.received[from] = transfers[from].values;
    }
    return exchange;
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): objects, octants, number of the first object, stop.
SortedList ListMaker::make(const EntrySource& source, const OctreeLayout& layout, std::uint32_t first_object,
                           const std::stop_token& stop) {
    const std::size_t octants = layout.directory.octants().size();
    memory_.resize(source.size(), 1, octants, 1);
    BuildSteps{source, layout.space, layout.directory, memory_, stop}.encode_and_scatter({0, {0, source.size()}});
    if (memory_.valid[0] == 0) throw LinearOctree::Invalid{0};
    entries_.resize_discard(std::size_t(entry_count(memory_, 0)));
    begins_.resize_discard(2 * octants);
    const MergedList sorted{entries_.span(), begins_.span().first(octants), begins_.span().subspan(octants)};
    sort_block(memory_, 0, sorted);
    for (CellEntry& entry : sorted.entries) entry.object += first_object;
    return {sorted.entries, sorted.home_begins, sorted.ghost_begins};
}

std::vector<SortedList> ListExchange::exchange(const SortedList& own, unsigned to) {
    const unsigned rank = comm_.rank();
    const std::size_t octants = own.home_begins.size();
    std::vector<ListTransfer> transfers = comm_.all_gather(ListTransfer{to, own.entries.size()});
    const Exchange entries = exchange_of(transfers, rank);
    for (ListTransfer& transfer : transfers) transfer.values = 2 * octants;
    const Exchange counts = exchange_of(transfers, rank);
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
    std::size_t begin = 0;  // first entry of the next list
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
