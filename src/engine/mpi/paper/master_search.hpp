// MasterSearch: runs a call of the paper's arrangement on one rank. This arrangement exists for comparison.
//
//   gather      all ranks send their objects to the master, rank 0
//   plan        the master chooses the octants of the octree and broadcasts them
//   distribute  the master sends each rank an equal run of the objects
//   list        each rank encodes and sorts its run                                           (rank_lists.hpp)
//   merge       the first rank of each machine merges the lists of the machine's ranks; the
//               master merges the results                                                     (rank_lists.hpp)
//   scan        the master scans alone, like the local engine                                 (master_passes.hpp)
//
// Result     the octree is that of the local engine, so the master finds the same pairs. The pieces of other ranks are empty.
//
// Source: Lucchesi, Egbert, Harris 2014, sections 3.3 and 4.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/paper/master_passes.hpp"
#include "engine/mpi/paper/rank_lists.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/search.hpp"

namespace octopair {

class MasterSearch {
public:
    /// Borrows `comm` and `costs`. Each call adds its time to `costs`.
    MasterSearch(Communicator& comm, RankCosts& costs, const MpiOptions& options);

    /// A call that all ranks have joined. Borrows all.
    struct Task {
        const detail::Output& output;
        const Options& options;
        const JointCall& joint;
        const std::array<Objects, 2>& slices;  ///< this rank's slice of each set
        StopRelay& stops;
        std::stop_token stop;
        const ProgressSink& progress;
    };
    /// Collective. Returns the summary of all ranks, except that its steps are those of this rank.
    /// Throws: as Agreement::together.
    Summary run(const Task& task);

private:
    using Sets = std::array<Objects, 2>;
    bool is_master() const { return comm_.rank() == 0; }
    static unsigned sets(const Task& task) { return task.joint.join ? 2 : 1; }
    Sets gather(const Task& task);
    OctreeLayout plan(const Task& task, const Sets& all);
    Sets distribute(const Task& task, const Sets& all);
    SortedList make_list(const Task& task, const Sets& own, const OctreeLayout& layout);
    std::vector<SortedList> bring_to_master(const Task& task, const SortedList& own);
    SortedList merge_machine(const Task& task, std::span<const SortedList> lists);
    Summary scan(const Task& task, const Sets& all);

    Communicator& comm_;
    RankCosts& costs_;
    unsigned ranks_per_machine_;
    MasterPasses passes_;
    Search search_{passes_};
    std::array<ObjectArrays, 2> gathered_, distributed_;
    ListMaker maker_;
    ListExchange within_machines_{comm_, costs_}, to_master_{comm_, costs_};
    Buffer<CellEntry> merged_;
    Buffer<std::uint64_t> merged_begins_;
};

}  // namespace octopair
