// MasterPasses: what the master of the paper's arrangement does alone: it merges the lists of all ranks, and scans.
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
    /// `costs`: build() adds to these. Borrows both.
    MasterPasses(Communicator& comm, RankCosts& costs, unsigned threads)
        : ThreadPasses(threads), comm_(comm), costs_(costs) {}

    /// Of the next build(), and all passes over it. Borrows the lists' contents and `stops`.
    void take(OctreeLayout layout, std::vector<SortedList> lists, StopRelay& stops) {
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
