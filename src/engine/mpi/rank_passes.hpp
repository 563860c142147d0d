// RankPasses: has the linear octree of a rank, which it builds unless entries were received, and scans the octants that the rank owns.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/ascending_pieces.hpp"
#include "engine/threads/thread_passes.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// Positions of the objects that a rank received, by set. Empty if pairs keep the numbers that the scan gives to objects.
using ObjectPositions = std::array<std::span<const std::uint32_t>, 2>;

/// How a writer changes pairs. Objects get their positions among the objects of all ranks. Then pairs that `wanted` excludes are dropped.
struct PairNaming {
    bool join = false;
    ObjectPositions positions = {};
    WantedRows wanted = {};
};

/// Runs the shares of a rank on another executor. Shares that run on the calling thread poll for stop requests of other ranks.
/// Requires: construction on the thread of the call. Only that thread polls for stop requests.
class RankExecutor final : public Executor {
public:
    /// Borrows `executor`, `stops` and the spans of `naming`.
    RankExecutor(Executor& executor, StopRelay& stops, const PairNaming& naming = {})
        : executor_(executor), stops_(stops), naming_(naming) {}

    unsigned width() const override { return std::min(most_width_, executor_.width()); }
    /// Sets an upper bound of width(), by which steps choose their number of shares.
    void limit_width(unsigned most) { most_width_ = most; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    void poll_stops();

    Executor& executor_;
    StopRelay& stops_;
    PairNaming naming_;
    unsigned most_width_ = std::numeric_limits<unsigned>::max();
    std::thread::id thread_ = std::this_thread::get_id();
};

/// Part of a call that one rank runs.
struct RankShare {
    std::optional<OctreeLayout> layout;   ///< octants of the octree to build; none if the octree is built
    OctantIndex begin = 0, end = 0;       ///< range of the octants that this rank owns
    const EntrySource* source = nullptr;  ///< source of the octree; if null, the objects of the call
    ObjectPositions positions = {};
};

class RankPasses final : public ThreadPasses {
public:
    explicit RankPasses(unsigned threads);

    /// Sets the share of the next build(). Borrows `stops`, and the source and positions of `share`, for all passes over that octree.
    void set_share(RankShare share, StopRelay& stops) {
        share_ = std::move(share);
        stops_ = &stops;
        wanted_ = {};
    }
    Team& threads() { return team(); }
    /// Returns the octree, so that its entries can be exchanged before build().
    LinearOctree& octree() { return ThreadPasses::octree(); }
    /// Restricts the pairs that passes write, until the next set_share(). Borrows `wanted.marks`.
    void set_wanted_rows(const WantedRows& wanted) { wanted_ = wanted; }
    /// Adds the pairs of each bin to `counts`.
    void count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress);

    /// Builds the octree, unless the share has no layout.
    /// Throws: LinearOctree::Invalid.
    void build(Call& call, double progress);

private:
    const EntrySource& searched(const Call& call) const {
        return share_.source != nullptr ? *share_.source : call.source;
    }

    RankShare share_;
    StopRelay* stops_ = nullptr;
    WantedRows wanted_;
};

}  // namespace octopair
