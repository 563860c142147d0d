#include "engine/mpi/entries/entry_exchange.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

namespace {

constexpr std::array octant_lists = {OctantList::home, OctantList::ghosts};

}  // namespace

/// Calls visit(entries) for each run of adjacent entries of a set in a list of an octant. A list of a join has the entries of the first
/// set before those of the second.
template <typename Visit>
void EntryExchange::for_each_run(OctantIndex octant, OctantList list, unsigned set, Visit&& visit) const {
    if (!call_.join) return octree_.for_each_run(octant, list, visit);
    octree_.for_each_run(octant, list, [&](std::span<const CellEntry> run) {
        const auto second = std::ranges::find_if(run, [](const CellEntry& entry) { return entry.ends[1] >> 31 != 0; });
        const auto of_first = std::size_t(second - run.begin());
        const auto part = set == 0 ? run.first(of_first) : run.subspan(of_first);
        if (!part.empty()) visit(part);
    });
}

EntryExchange::EntryExchange(Communicator& comm, const JointCall& call, LinearOctree& octree, Memory& memory)
    : comm_(comm), call_(call), octree_(octree), memory_(memory), sets_(call.join ? 2 : 1) {}

std::vector<std::uint32_t> EntryExchange::entries() const {
    std::vector<std::uint32_t> entries(octree_.octants().size());
    for (OctantIndex octant = 0; octant < entries.size(); ++octant)
        entries[octant] = std::uint32_t(octree_.entry_count(octant));
    return entries;
}

void EntryExchange::pack(Executor& executor, const OctantOwners& owners) {
    owners_ = &owners;
    std::vector<std::size_t> places = {0};
    count_begins_.assign(1, 0);
    sent_.assign(owners.ranks(), 0);
    for (unsigned rank = 0; rank < owners.ranks(); ++rank) {
        const auto octants = is_packed(rank) ? owners.octants_of(rank) : std::span<const OctantIndex>();
        for (const OctantIndex octant : octants)
            sent_[rank] += octree_.octants()[octant].leaf() ? octree_.entry_count(octant) : 0;
        places.push_back(places.back() + std::size_t(sent_[rank]));
        count_begins_.push_back(count_begins_.back() + sets_ * lists * octants.size());
    }
    received_counts_.resize(owners.ranks() * sets_ * lists * owners.octants_of(comm_.rank()).size());
    sent_counts_.resize(count_begins_.back());
    memory_.sent.resize_discard(places.back());
    executor.for_each(owners.ranks(), [&](std::size_t rank) {
        if (is_packed(unsigned(rank))) pack(unsigned(rank), memory_.sent.data() + places[rank]);
    });
}

/// Copies the entries that are sent to a rank, and sets the numbers of entries of their lists.
void EntryExchange::pack(unsigned rank, CellEntry* out) {
    Count* counts = sent_counts_.data() + count_begins_[rank];
    for (unsigned set = 0; set < sets_; ++set) {
        for (const OctantIndex octant : owners_->octants_of(rank)) {
            for (const OctantList list : octant_lists) {
                const CellEntry* const begin = out;
                const auto copy = [&](std::span<const CellEntry> run) { out = std::copy(run.begin(), run.end(), out); };
                if (octree_.octants()[octant].leaf()) for_each_run(octant, list, set, copy);
                *counts++ = Count(out - begin);
            }
        }
    }
}

void EntryExchange::exchange() {
    const std::size_t own_counts = sets_ * lists * owners_->octants_of(comm_.rank()).size();
    Exchange counts{RankCounts(comm_.size()), RankCounts(comm_.size())};
    for (unsigned rank = 0; rank < comm_.size(); ++rank) {
        counts.sent[rank] = count_begins_[rank + 1] - count_begins_[rank];
        counts.received[rank] = is_packed(rank) ? own_counts : 0;
    }
    comm_.exchange(sent_counts_.data(), received_counts_.data(), counts);

    Exchange entries{sent_, RankCounts(comm_.size(), 0)};
    const Count* count = received_counts_.data();
    for (unsigned rank = 0; rank < comm_.size(); count += counts.received[rank++])
        entries.received[rank] = std::accumulate(count, count + counts.received[rank], std::uint64_t(0));
    Agreement(comm_).together([&] { memory_.received.resize_discard(entries.incoming()); });
    comm_.exchange(memory_.sent.data(), memory_.received.data(), entries);
}

void EntryExchange::arrange(const InnerEntries& inner) {
    const unsigned ranks = comm_.size(), own = comm_.rank();
    const std::size_t set_counts = owners_->octants_of(own).size() * lists;
    /// The entries of one set from one rank that are not yet arranged, and their counts.
    struct Message {
        const CellEntry* entries;
        const Count* counts;
        bool packed;
    };
    std::vector<Message> messages(sets_ * ranks);  // set after set
    const CellEntry* entries = memory_.received.data();
    const Count* counts = received_counts_.data();
    for (unsigned rank = 0; rank < ranks; ++rank) {
        for (unsigned set = 0; set < sets_; ++set) {
            messages[set * ranks + rank] = {entries, counts, is_packed(rank)};
            if (!is_packed(rank)) continue;
            entries = std::accumulate(counts, counts + set_counts, entries);
            counts += set_counts;
        }
    }
    EntryRuns runs;
    runs.begins.reserve(octree_.octants().size() + 1);
    runs.runs.reserve(messages.size() * set_counts);
    const auto add = [&](std::span<const CellEntry> run) {
        if (!run.empty()) runs.runs.push_back(run);
    };
    for (OctantIndex octant = 0; octant < octree_.octants().size(); ++octant) {
        runs.begins.push_back(runs.runs.size());
        const bool leaf = octree_.octants()[octant].leaf();
        if (!leaf) add(inner.of(octant));
        if (owners_->owner(octant) != own) continue;
        for (const OctantList list : octant_lists) {
            for (Message& message : messages) {
                if (message.packed) {
                    add({message.entries, *message.counts});
                    message.entries += *message.counts++;
                } else if (leaf) {
                    octree_.for_each_run(octant, list, add);
                }
            }
        }
    }
    runs.begins.push_back(runs.runs.size());
    octree_.arrange(std::move(runs));
}

}  // namespace octopair
