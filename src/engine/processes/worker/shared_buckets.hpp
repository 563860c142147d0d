// SharedBuckets: the buckets of a worker in shared memory, from which several workers sort pairs into ascending order. Each slot has its
// own buckets (bucket_sort.hpp), and the buckets are sorted as shares of a last step.
//
// Invariants
//   Each share that is done has committed the content of its slot's buckets: their pages and numbers of pairs.
//   A replacement worker continues from the last commit of its slot.
//   Pages that a dead worker took after its slot's last commit do not count towards the budget of pages.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/processes/worker/worker_place.hpp"

namespace octopair {

class SharedBuckets {
public:
    using Buckets = std::vector<PageString>;
    SharedBuckets(const WorkerPlace& place, const Pass& pass);
    SharedBuckets(const SharedBuckets&) = delete;
    SharedBuckets& operator=(const SharedBuckets&) = delete;

    /// The place of an AscendingOutput.
    struct Place {
        SharedBuckets* shared;
        Pages& pages() const { return shared->pages_; }
        void begin(Buckets& buckets) const { shared->restore(buckets); }
        void record(const WorkerPlace::Share& share, const Buckets& buckets) const { shared->commit(share, buckets); }
    };
    /// Returns an output that fills the buckets of this worker. Borrows this object.
    AscendingOutput<Place> output() { return {plan_, Place{this}}; }

    /// Sorts the buckets of all slots. Requires: called as the last step of the pass, after the scan.
    void order(WorkSharing& shares);

private:
    void restore(Buckets& buckets);
    void commit(const WorkerPlace::Share& share, const Buckets& buckets);
    std::uint64_t last_commit(unsigned slot) const;
    Buckets committed(unsigned slot) const;

    WorkerPlace place_;
    const unsigned workers_;
    const BucketPlan plan_;
    PageBudget budget_;
    Pages pages_;
    std::vector<std::size_t> logged_;  // for each bucket: number of its pages in the log
    std::uint64_t log_size_ = 0;
    std::uint64_t commit_ = 0;  // number of the last commit
    bool restored_ = false;
};

}  // namespace octopair
