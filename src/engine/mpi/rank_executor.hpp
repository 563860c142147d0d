// RankExecutor: runs the shares of a rank on another executor.
//
// Stops      shares that run on the calling thread poll for stop requests of other ranks.
// Pairs      objects of a pair are renumbered from the rank's own numbers to positions in the set, which are the same on all
//            ranks. Unwanted pairs are dropped.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <thread>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/row_bins.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// Position of each object of a rank, by its number on this rank. Empty: numbers stay unchanged.
struct PairNumbers {
    std::span<const std::uint32_t> a = {}, b = {};
};

/// Requires: construction on the thread of the call. Only that thread polls for stop requests.
class RankExecutor final : public Executor {
public:
    /// Borrows `executor`, `stops` and the arrays of `numbers` and `wanted`.
    RankExecutor(Executor& executor, StopRelay& stops, const PairNumbers& numbers = {}, const WantedRows& wanted = {})
        : executor_(executor), stops_(stops), numbers_(numbers), wanted_(wanted) {}

    unsigned width() const override { return executor_.width(); }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    void poll_stops();

    Executor& executor_;
    StopRelay& stops_;
    PairNumbers numbers_;
    WantedRows wanted_;
    std::thread::id thread_ = std::this_thread::get_id();
};

}  // namespace octopair
