// RankExecutor: an executor of one rank, whose shares look out for the stops of other ranks, and whose pairs come out with
// the numbers that all ranks know.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <thread>

#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/order/row_bins.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// What the objects of a rank are called elsewhere: a pair's `a` and `b` are looked up. Empty: as they are.
struct PairNumbers {
    std::span<const std::uint32_t> a = {}, b = {};
};

/// To be made on the thread of the call.
class RankExecutor final : public Executor {
public:
    /// Borrows all.
    RankExecutor(Executor& executor, StopRelay& stops, const PairNumbers& numbers = {}, const WantedRows& wanted = {})
        : executor_(executor), stops_(stops), numbers_(numbers), wanted_(wanted) {}

    unsigned width() const override { return executor_.width(); }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override;
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;

private:
    class Writer;
    void look_out();

    Executor& executor_;
    StopRelay& stops_;
    PairNumbers numbers_;
    WantedRows wanted_;
    std::thread::id thread_ = std::this_thread::get_id();
};

}  // namespace octopair
