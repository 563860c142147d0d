#include "engine/mpi/paper/master_search.hpp"

#include <algorithm>
#include <utility>

#include "base/timed.hpp"
#include "engine/mpi/bad_object.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/cost_meter.hpp"

namespace octopair {

namespace {

Objects part_of(const Objects& all, std::size_t begin, std::size_t count) {
    const auto padding = all.padding.empty() ? all.padding : all.padding.subspan(begin, count);
    return std::visit([&](const auto& boxes) { return Objects{boxes.subspan(begin, count), padding}; }, all.boxes);
}

/// Assignment of objects to ranks: one run of the objects of all sets, in order. So a run may have objects of both sets.
class Runs {
public:
    Runs(const JointCall& joint, unsigned ranks) : joint_(joint), ranks_(ranks) {}

    std::uint64_t begin(unsigned rank) const { return joint_.objects() * rank / ranks_; }
    /// Returns the begin of the rank's run within a set.
    std::uint64_t begin(unsigned rank, unsigned set) const { return within(begin(rank), set); }
    std::uint64_t size(unsigned rank, unsigned set) const { return begin(rank + 1, set) - begin(rank, set); }

private:
    std::uint64_t within(std::uint64_t position, unsigned set) const {
        const std::uint64_t first = set == 0 ? 0 : joint_.totals[0];
        return std::clamp(position, first, first + joint_.totals[set]) - first;
    }

    const JointCall& joint_;
    unsigned ranks_;
};

void set_form(ObjectArrays& arrays, const JointCall& joint, unsigned set) {
    arrays.wide = joint.wide[set];
    arrays.padded = joint.padded[set];
}

BoxSource source_of(const JointCall& joint, const std::array<Objects, 2>& sets) {
    return {sets[0], joint.join ? &sets[1] : nullptr, joint.form};
}

/// Result of the master's search. Broadcast to the other ranks.
struct Found {
    std::uint64_t pairs = 0, entries = 0;
    bool truncated = false;
};

}  // namespace

MasterSearch::MasterSearch(Communicator& comm, RankCosts& costs, const MpiOptions& options)
    : comm_(comm),
      costs_(costs),
      ranks_per_machine_(options.ranks_per_machine),
      passes_(comm, costs, options.threads) {}

Summary MasterSearch::run(const Task& task) {
    const Sets all = gather(task);
    OctreeLayout layout = plan(task, all);
    const Sets own = distribute(task, all);
    Summary summary;
    SortedList list;
    {
        const Timed timed(summary.steps.encode);
        list = make_list(task, own, layout);
    }
    std::vector<SortedList> lists = bring_to_master(task, list);
    Found found;
    Agreement(comm_).together([&] {
        if (!is_master()) return;
        passes_.set_lists(std::move(layout), std::move(lists), task.stops);
        const Summary whole = scan(task, all);
        found = {whole.pairs, whole.entries, whole.truncated};
        summary.steps.merge = whole.steps.merge;
        summary.steps.scan = whole.steps.scan;
    });
    comm_.broadcast(std::span(&found, 1), 0);
    summary.pairs = found.pairs;
    summary.entries = found.entries;
    summary.truncated = found.truncated;
    return summary;
}

/// Returns all objects on the master, and empty sets on other ranks.
MasterSearch::Sets MasterSearch::gather(const Task& task) {
    const JointCall& joint = task.joint;
    const auto sizes = comm_.all_gather(joint.sizes);
    Sets all;
    for (unsigned set = 0; set < sets(task); ++set) {
        Exchange counts{RankCounts(comm_.size(), 0), RankCounts(comm_.size(), 0)};
        if (!is_master()) counts.sent[0] = joint.sizes[set];
        for (unsigned rank = 1; is_master() && rank < comm_.size(); ++rank) counts.received[rank] = sizes[rank][set];
        ObjectArrays& arrays = gathered_[set];
        set_form(arrays, joint, set);
        const bool some_come = counts.incoming() > 0;
        Agreement(comm_).together([&] {
            if (!some_come) return;
            const Metered metered(comm_, costs_.pack);
            arrays.resize(std::size_t(joint.totals[set]));
            arrays.copying(task.slices[set], [&](const auto& copy) {
                for (std::size_t i = 0; i < joint.sizes[set]; ++i) copy(i, i);
            });
        });
        exchange_objects(comm_, task.slices[set], arrays, counts, std::size_t(some_come ? joint.sizes[set] : 0));
        all[set] = some_come ? arrays.view() : is_master() ? task.slices[set] : joint.slice(set, {});
    }
    return all;
}

OctreeLayout MasterSearch::plan(const Task& task, const Sets& all) {
    Agreement agreement(comm_);
    OctreePlan plan;
    agreement.together([&] {
        if (!is_master()) return;
        const Metered metered(comm_, costs_.plan);
        plan = plan_octree(source_of(task.joint, all), task.stop);
    });
    std::uint64_t octants = plan.shape.size();
    comm_.broadcast(std::span(&plan.space, 1), 0);
    comm_.broadcast(std::span(&octants, 1), 0);
    agreement.together([&] { plan.shape.resize(std::size_t(octants)); });
    comm_.broadcast(std::span(plan.shape), 0);
    OctreeLayout layout;
    agreement.together([&] {
        const Metered metered(comm_, costs_.plan);
        layout = plan.layout();
    });
    return layout;
}

/// Returns this rank's run. The master's run stays in place.
MasterSearch::Sets MasterSearch::distribute(const Task& task, const Sets& all) {
    const JointCall& joint = task.joint;
    const Runs runs(joint, comm_.size());
    Sets own;
    for (unsigned set = 0; set < sets(task); ++set) {
        Exchange counts{RankCounts(comm_.size(), 0), RankCounts(comm_.size(), 0)};
        if (!is_master()) counts.received[0] = runs.size(comm_.rank(), set);
        for (unsigned rank = 1; is_master() && rank < comm_.size(); ++rank) counts.sent[rank] = runs.size(rank, set);
        ObjectArrays& arrays = distributed_[set];
        set_form(arrays, joint, set);
        Agreement(comm_).together([&] {
            const Metered metered(comm_, costs_.pack);
            arrays.resize(counts.incoming());
        });
        const auto kept = std::size_t(is_master() ? runs.size(0, set) : 0);
        exchange_objects(comm_, part_of(all[set], kept, all[set].size() - kept), arrays, counts);
        own[set] = is_master() ? part_of(all[set], 0, kept) : arrays.view();
        costs_.objects_received += counts.incoming();
    }
    return own;
}

SortedList MasterSearch::make_list(const Task& task, const Sets& own, const OctreeLayout& layout) {
    const Runs runs(task.joint, comm_.size());
    const BoxSource source = source_of(task.joint, own);
    const std::uint64_t begin = runs.begin(comm_.rank());
    SortedList list;
    Agreement(comm_).together([&] {
        const Metered metered(comm_, costs_.build);
        try {
            list = maker_.make(source, layout, std::uint32_t(begin), task.stop);
        } catch (const LinearOctree::Invalid& invalid) {
            const SetBegins begins{runs.begin(comm_.rank(), 0), runs.begin(comm_.rank(), 1)};
            refuse_object(
                source, invalid.begin, [&](std::size_t number) { return begin + number; },
                [&](std::size_t) { return begins; });
        }
    });
    return list;
}

/// Returns, on the master, the lists to merge: those of the ranks of its machine, and one merged list of each other machine.
std::vector<SortedList> MasterSearch::bring_to_master(const Task& task, const SortedList& own) {
    const unsigned rank = comm_.rank(), leader = rank - rank % ranks_per_machine_;
    std::vector<SortedList> lists = within_machines_.exchange(own, leader);
    lists.insert(lists.begin(), own);
    SortedList merged = own;
    Agreement(comm_).together([&] {
        if (rank == leader && !is_master() && lists.size() > 1) merged = merge_machine(task, lists);
    });
    const std::vector<SortedList> of_machines = to_master_.exchange(merged, rank == leader ? 0 : rank);
    lists.insert(lists.end(), of_machines.begin(), of_machines.end());
    return lists;
}

SortedList MasterSearch::merge_machine(const Task& task, std::span<const SortedList> lists) {
    const Metered metered(comm_, costs_.merge);
    std::size_t entries = 0;
    for (const SortedList& list : lists) entries += list.entries.size();
    const std::size_t octants = lists[0].home_begins.size();
    merged_.resize_discard(entries);
    merged_begins_.resize_discard(2 * octants);
    const std::span<std::uint64_t> begins = merged_begins_.span();
    const MergedList merged{merged_.span(), begins.first(octants), begins.subspan(octants)};
    (void)merge_lists(lists, merged, task.stop);
    return {merged.entries, merged.home_begins, merged.ghost_begins};
}

Summary MasterSearch::scan(const Task& task, const Sets& all) {
    const double merged = costs_.merge;
    Summary summary;
    {
        const Metered metered(comm_, costs_.scan);
        const detail::Request request{all[0], task.joint.join ? &all[1] : nullptr, task.options};
        summary = search_.run(request, task.output, {task.stop, task.progress});
    }
    costs_.scan -= costs_.merge - merged;  // the merge is part of the search
    return summary;
}

}  // namespace octopair
