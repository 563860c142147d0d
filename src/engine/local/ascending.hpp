// The ascending order of pairs: by a, then b.
//
// The scan throws its pairs into buckets of neighbouring `a`, in pages of the list's own memory. Each bucket is then
// sorted where it lies and its pages become the list, so that order takes a bucket a thread beside the pairs, and does
// not show which thread found what.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "engine/local/pair_pages.hpp"
#include "engine/local/writers.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

/// Objects [begin, end).
struct ObjectRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;
};

/// Appends the pairs whose `a` is in a range to a list, in ascending order.
class AscendingExecutor final : public TeamExecutor {
public:
    struct Bounds {
        ObjectRange rows;                            ///< the `a` that are wanted
        std::uint64_t columns = 0;                   ///< above every `b`
        std::uint64_t most = ~std::uint64_t(0) / 2;  ///< pairs for whom there may be pages
        std::uint64_t expected = 0;                  ///< pairs, if that is known
    };
    /// Thrown by a scan that needs more pages than `most` allows; no more than a quarter of them is not full.
    using OverBudget = Pages::OverBudget;

    AscendingExecutor(Team& team, PairList::Storage& list, const Bounds& bounds);
    ~AscendingExecutor() override;

    void for_each_writing(std::size_t count, const std::function<void(std::size_t, PairWriter&)>& body) override;
    /// To be called once, after the scan. Throws Error{cancelled}.
    void append_sorted(const std::stop_token& stop);

private:
    class Buckets;
    std::unique_ptr<Buckets> buckets_;
};

}  // namespace octopair
