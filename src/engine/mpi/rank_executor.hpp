// RankExecutor: runs the shares of a rank on another executor.
//
// Stops      shares that run on the calling thread poll for stop requests of other ranks.
// Pairs      unwanted pairs are dropped.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <thread>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/row_bins.hpp"
#include "octree/executor.hpp"

namespace octopair {

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

}  // namespace octopair
