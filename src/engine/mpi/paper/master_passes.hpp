// MasterPasses: the passes that the master of the paper's arrangement runs alone: merge of the lists of all ranks, and scan.
#pragma once

#include <utility>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/rank_executor.hpp"
#include "engine/threads/thread_passes.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

class MasterPasses final : public ThreadPasses {
public:
    /// Borrows `comm` and `costs`. build() adds its time to `costs`.
    MasterPasses(Communicator& comm, RankCosts& costs, unsigned threads)
        : ThreadPasses(threads), comm_(comm), costs_(costs) {}

    /// Sets the lists that the next build() merges. Borrows `stops` and the lists' memory for all passes over that octree.
    void set_lists(OctreeLayout layout, std::vector<SortedList> lists, StopRelay& stops) {
        layout_ = std::move(layout);
        lists_ = std::move(lists);
        stops_ = &stops;
    }

    void build(Call& call, double progress) override;

private:
    void scan_into(Call& call, Executor& executor, double progress) override;

    Communicator& comm_;
    RankCosts& costs_;
    OctreeLayout layout_;
    std::vector<SortedList> lists_;
    StopRelay* stops_ = nullptr;
};

}  // namespace octopair
