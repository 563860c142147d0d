// RankPasses: builds the linear octree of the objects that a rank received, and scans the octants that the rank owns.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/ascending_pieces.hpp"
#include "engine/mpi/positioned_source.hpp"
#include "engine/threads/thread_passes.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// Runs the shares of a rank on another executor. Shares that run on the calling thread poll for stop requests of other ranks. Drops
/// pairs that `wanted` excludes.
/// Requires: construction on the thread of the call. Only that thread polls for stop requests.
class RankExecutor final : public Executor {
public:
    /// Borrows `executor`, `stops` and `wanted.marks`.
    RankExecutor(Executor& executor, StopRelay& stops, const WantedRows& wanted = {})
        : executor_(executor), stops_(stops), wanted_(wanted) {}

    unsigned width() const override { return executor_.width(); }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    void poll_stops();

    Executor& executor_;
    StopRelay& stops_;
    WantedRows wanted_;
    std::thread::id thread_ = std::this_thread::get_id();
};

/// Part of a call that one rank runs.
struct RankShare {
    OctreeLayout layout;
    OctantIndex begin = 0, end = 0;  ///< range of the octants that this rank owns
    std::optional<ObjectPositions> positions =
        {};  ///< if set, pairs have positions in place of this rank's own numbers
};

class RankPasses final : public ThreadPasses {
public:
    explicit RankPasses(unsigned threads);

    /// Sets the share of the next build(). Borrows `stops` and `share.positions` for all passes over that octree.
    void set_share(RankShare share, StopRelay& stops) {
        share_ = std::move(share);
        stops_ = &stops;
        wanted_ = {};
    }
    Team& threads() { return team(); }
    /// Restricts the pairs that passes write, until the next set_share(). Borrows `wanted.marks`.
    void set_wanted_rows(const WantedRows& wanted) { wanted_ = wanted; }
    /// Adds the pairs of each bin to `counts`.
    void count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress);

    /// Throws: LinearOctree::Invalid.
    void build(Call& call, double progress);

private:
    const EntrySource& searched(const Call& call) const;

    RankShare share_;
    StopRelay* stops_ = nullptr;
    WantedRows wanted_;
    std::optional<PositionedSource> positioned_;  // source of the octree, if the share has positions
};

}  // namespace octopair
