// AscendingExecutor: sorts pairs into ascending order (by a, then b) on the threads of this process.
//
// The scan scatters pairs into buckets, in pages of the list's own memory. Each bucket is then sorted into pages of the same
// memory, and these pages form the list. Beside the pairs, sorting needs memory for one bucket for each thread.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "base/private_export.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_list.hpp"
#include "engine/threads/writers.hpp"

namespace octopair {

/// Appends the pairs whose `a` is in the range of rows to a list, in ascending order.
class OCTOPAIR_PRIVATE_EXPORT AscendingExecutor final : public TeamExecutor {
public:
    AscendingExecutor(Team& team, detail::PairStorage& list, const AscendingBounds& bounds);
    ~AscendingExecutor() override;

    /// Throws: OverBudget.
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override;
    /// Returns the number of pairs in the buckets.
    std::uint64_t pairs() const;
    /// Called with the number of pairs of each sorted bucket, on any thread of the team.
    using OnSorted = std::function<void(std::uint64_t)>;
    /// Sorts the buckets and appends their pairs to the list. Requires: called once, after the scan.
    /// Throws: Error{cancelled}; what `on_sorted` throws.
    void append_sorted(const std::stop_token& stop, const OnSorted& on_sorted = {});

private:
    class Buckets;
    std::unique_ptr<Buckets> buckets_;
};

}  // namespace octopair
