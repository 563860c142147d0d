// RankPasses: the linear octree of what a rank has received, and scans of the octants that it owns.
#pragma once

#include <optional>
#include <utility>

#include "engine/mpi/rank_executor.hpp"
#include "engine/threads/thread_passes.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// What a rank does of a call.
struct RankShare {
    OctreeLayout layout;
    OctantIndex begin = 0, end = 0;  ///< those that this rank owns
    PairNumbers numbers = {};
};

class RankPasses final : public ThreadPasses {
public:
    using ThreadPasses::ThreadPasses;

    /// Of the next build(). `stops` and the numbers are borrowed for all passes over it.
    void take(RankShare share, StopRelay& stops) {
        share_ = std::move(share);
        stops_ = &stops;
        wanted_ = {};
    }
    Team& threads() { return team(); }
    /// Of the passes from here to the next take(): which pairs they write. Borrowed.
    void want(const WantedRows& wanted) { wanted_ = wanted; }
    /// Adds the pairs of each bin to `counts`.
    void count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress);

    /// Throws LinearOctree::Invalid.
    void build(Call& call, double progress) override;

private:
    void scan_into(Call& call, Executor& executor, double progress) override;

    RankShare share_;
    StopRelay* stops_ = nullptr;
    WantedRows wanted_;
};

}  // namespace octopair
