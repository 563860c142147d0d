// The ascending order of pairs, on the threads of this process: by a, then b.
//
// The scan throws its pairs into buckets, in pages of the list's own memory. Each bucket is then sorted where it lies and
// its pages become the list, so that order takes a bucket a thread beside the pairs.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "engine/ascending_bounds.hpp"
#include "engine/pair_list.hpp"
#include "engine/threads/writers.hpp"

namespace octopair {

/// Appends the pairs whose `a` is in a range to a list, in ascending order.
class AscendingExecutor final : public TeamExecutor {
public:
    AscendingExecutor(Team& team, detail::PairStorage& list, const AscendingBounds& bounds);
    ~AscendingExecutor() override;

    /// Throws OverBudget.
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;
    /// To be called once, after the scan. Throws Error{cancelled}.
    void append_sorted(const std::stop_token& stop);

private:
    class Buckets;
    std::unique_ptr<Buckets> buckets_;
};

}  // namespace octopair
