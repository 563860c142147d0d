// SharedBuckets: sorts pairs into ascending order with several workers. Each slot has its own buckets (bucket_sort.hpp), and
// the buckets are sorted as shares of a last step.
//
// Invariants
//   Each share that is done has committed the content of its slot's buckets: their pages and numbers of pairs.
//   A replacement worker continues from the last commit of its slot.
//   Pages that a dead worker took after its slot's last commit do not count towards the budget of pages.
#pragma once

#include <vector>

#include "engine/processes/worker/share_output.hpp"

namespace octopair {

class SharedBuckets final : public ShareOutput {
public:
    SharedBuckets(const OutputPlace& place, const Pass& pass);
    ~SharedBuckets() override;

    ShareWriter& begin(const WorkSharing::ClaimedShare& share) override;
    void end(const WorkSharing::ClaimedShare& share) override;

    /// Sorts the buckets of all slots. Requires: called as the last step of the pass, after the scan.
    void order(WorkSharing& shares);

private:
    class RegionPages;
    class Writer;
    using Strings = std::vector<PageString>;  // the pages of each bucket
    void restore();
    std::uint64_t last_commit(unsigned slot) const;
    Strings committed_strings(unsigned slot) const;

    OutputPlace place_;
    const unsigned workers_;
    const BucketPlan plan_;
    std::unique_ptr<RegionPages> pages_;
    Strings strings_;
    std::vector<std::size_t> logged_;  // for each bucket: number of its pages in the log
    std::uint64_t log_size_ = 0;
    std::uint64_t commit_ = 0;  // number of the last commit
    bool restored_ = false;
    std::unique_ptr<Writer> writer_;
};

}  // namespace octopair
