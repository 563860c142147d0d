// The ascending order among workers: each slot has buckets of its own (bucket_sort.hpp), and the buckets are sorted as
// shares of a last step.
//
// What a slot's buckets hold is committed with each share that is done: which pages they have, and how many pairs. So a
// worker that takes over a slot goes on from the last share that was done, and what was taken for others is not counted.
#pragma once

#include <vector>

#include "engine/processes/worker/share_output.hpp"

namespace octopair {

class SharedBuckets final : public ShareOutput {
public:
    SharedBuckets(const OutputPlace& place, const Pass& pass);
    ~SharedBuckets() override;

    ShareWriter& begin(const WorkSharing::Task& task) override;
    void end(const WorkSharing::Task& task) override;

    /// The last step: sorts the buckets of all slots.
    void order(WorkSharing& shares);

private:
    class RegionPages;
    class Writer;
    using Strings = std::vector<PageString>;  // by bucket
    void restore();
    std::uint64_t last_commit(unsigned slot) const;
    Strings committed_strings(unsigned slot) const;

    OutputPlace place_;
    const unsigned workers_;
    const BucketPlan plan_;
    std::unique_ptr<RegionPages> pages_;
    Strings strings_;
    std::vector<std::size_t> logged_;  // pages of each bucket
    std::uint64_t log_size_ = 0;
    std::uint64_t commit_ = 0;  // the last one
    bool restored_ = false;
    std::unique_ptr<Writer> writer_;
};

}  // namespace octopair
