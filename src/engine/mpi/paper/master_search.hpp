// MasterSearch: what a rank does in a call of the paper's arrangement, which is there to be compared with.
//
//   gather  all objects to the master, rank 0, from the ranks that have some
//   plan    the octree's octants: the master, which tells all
//   deal    equal runs of objects: the master, to all ranks
//   list    encoded and sorted: each rank its run                                             (list_maker.hpp)
//   merge   the lists of a machine's ranks: the first of these; the lists of all: the master  (list_exchange.hpp)
//   scan    the master, alone, as the local engine would                                      (master_passes.hpp)
//
// The octree is that of the local engine, so the master finds what that finds; the others' pieces are empty.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.3 and 4.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/paper/list_exchange.hpp"
#include "engine/mpi/paper/list_maker.hpp"
#include "engine/mpi/paper/master_passes.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/search.hpp"

namespace octopair {

class MasterSearch {
public:
    /// `costs`: each call adds to these. Borrows both.
    MasterSearch(Communicator& comm, RankCosts& costs, const MpiOptions& options);

    /// A call that all ranks have joined. Borrows all.
    struct Task {
        const detail::Output& output;
        const Options& options;
        const JointCall& joint;
        const std::array<Objects, 2>& slices;  ///< that this rank brought
        StopRelay& stops;
        std::stop_token stop;
        const ProgressSink& progress;
    };
    /// Collective. The summary is that of all ranks, but for the steps, which are this rank's. Throws as Agreement::together.
    Summary run(const Task& task);

private:
    using Sets = std::array<Objects, 2>;
    bool is_master() const { return comm_.rank() == 0; }
    static unsigned sets(const Task& task) { return task.joint.join ? 2 : 1; }
    Sets gather(const Task& task);
    OctreeLayout plan(const Task& task, const Sets& all);
    Sets deal_out(const Task& task, const Sets& all);
    SortedList make_list(const Task& task, const Sets& own, const OctreeLayout& layout);
    std::vector<SortedList> bring_to_master(const Task& task, const SortedList& own);
    SortedList merge_machine(const Task& task, std::span<const SortedList> lists);
    Summary scan(const Task& task, const Sets& all);

    Communicator& comm_;
    RankCosts& costs_;
    unsigned ranks_per_machine_;
    MasterPasses passes_;
    Search search_{passes_};
    std::array<ObjectArrays, 2> gathered_, dealt_;
    ListMaker maker_;
    ListExchange within_machines_{comm_, costs_}, to_master_{comm_, costs_};
    Buffer<Entry> merged_;
    Buffer<std::uint64_t> merged_begins_;
};

}  // namespace octopair
