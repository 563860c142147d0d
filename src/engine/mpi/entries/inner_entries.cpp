#include "engine/mpi/entries/inner_entries.hpp"

#include <algorithm>
#include <utility>

#include "base/test_hooks.hpp"
#include "engine/mpi/comm/agreement.hpp"

namespace octopair {

namespace {

unsigned set_of(std::span<const std::uint32_t, 3> ends) { return ends[1] >> CellEntry::set_shift; }

/// Collects the entries of inner octants for the ranks that need them.
class Collector {
public:
    /// Borrows all arguments.
    Collector(const JointCall& call, const LinearOctree& octree, const BoxSource& own, const OctantOwners& owners)
        : call_(call), octree_(octree), own_(own), owners_(owners), to_rank_(owners.ranks()) {}

    std::vector<std::vector<InnerEntry>> collect() {
        const auto octants = octree_.octants();
        for (OctantIndex octant = 0; octant < octants.size(); ++octant) {
            if (octants[octant].leaf() || octree_.entry_count(octant) == 0) continue;
            octree_.for_each_run(octant, [&](std::span<const CellEntry> run) { collect(octant, run); });
        }
        return std::move(to_rank_);
    }

private:
    void collect(OctantIndex octant, std::span<const CellEntry> run) {
        std::vector<Entry> bounds(run.size());
        for (std::size_t i = 0; i < run.size(); ++i) bounds[i].object = std::uint32_t(call_.own_number(run[i].object));
        own_.load_bounds(bounds);
        std::vector<CellBox> boxes(run.size());
        octree_.space().cells(bounds, boxes);
        for (std::size_t i = 0; i < run.size(); ++i) collect(octant, run[i], boxes[i]);
    }

    void collect(OctantIndex octant, const CellEntry& entry, const CellBox& box) {
        ranks_.clear();
        const auto place = [&](unsigned rank) { ranks_.push_back(rank); };
        owners_.for_each_owner_below(box, octree_.directory(), octant, place);
        std::ranges::sort(ranks_);
        ranks_.erase(std::unique(ranks_.begin(), ranks_.end()), ranks_.end());
        count_path(ranks_.size() > 1 ? Path::inner_entry_on_ranks : Path::inner_entry_on_rank);
        for (const unsigned rank : ranks_) to_rank_[rank].push_back({octant, entry.ends, entry.object});
    }

    const JointCall& call_;
    const LinearOctree& octree_;
    const BoxSource& own_;
    const OctantOwners& owners_;
    std::vector<std::vector<InnerEntry>> to_rank_;
    std::vector<unsigned> ranks_;
};

}  // namespace

void InnerEntries::exchange(const JointCall& call, const LinearOctree& octree, const BoxSource& own,
                            const OctantOwners& owners) {
    Agreement agreement(comm_);
    std::vector<InnerEntry> sent, received;
    RankCounts to_each;
    agreement.together([&] {
        for (const auto& entries : Collector(call, octree, own, owners).collect()) {
            sent.insert(sent.end(), entries.begin(), entries.end());
            to_each.push_back(entries.size());
        }
    });
    const Exchange counts = comm_.plan_exchange(std::move(to_each));
    agreement.together([&] { received.resize(counts.incoming()); });
    comm_.exchange(sent.data(), received.data(), counts);
    agreement.together([&] { sort(std::move(received)); });
}

/// Sorts entries by octant. In an octant, entries ascend by set and position.
void InnerEntries::sort(std::vector<InnerEntry> received) {
    std::ranges::stable_sort(received, {},
                             [](const InnerEntry& entry) { return std::pair(entry.octant, set_of(entry.ends)); });
    for (const InnerEntry& entry : received) {
        octants_.push_back(entry.octant);
        entries_.push_back({entry.ends, entry.object});
    }
}

std::span<const CellEntry> InnerEntries::of(OctantIndex octant) const {
    const auto range = std::ranges::equal_range(octants_, octant);
    return std::span(entries_).subspan(std::size_t(range.begin() - octants_.begin()), range.size());
}

}  // namespace octopair
