// Outputs: they count, list or sort the pairs of a scan. Each thread or worker has an output of its own, and fills it share by share:
//
//   begin(share)    begins a share
//   write(pairs)    takes the next pairs of the share (ShareWriter)
//   commit(share)   records the share
//
// Nothing of a share is visible before its commit, except in counts by bin. An output whose share fails is not used again.
//
// The Place of an output says where memory for pairs comes from, and where a committed share is recorded:
//   threads    blocks of the list; arrays of the thread                        (engine/threads/team_output.cpp)
//   workers    blocks of shared memory; tables of the control block, from which a replacement worker goes on
//                                                                              (engine/processes/worker/worker_place.hpp)
// Streams have other outputs: OrderedStream (engine/threads/stream.cpp) and RingOutput (engine/processes/worker/worker_place.hpp).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/test_hooks.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_pages.hpp"
#include "octopair/error.hpp"
#include "octree/executor.hpp"

namespace octopair {

/// Runs of pairs, in order. Runs that are adjacent in memory are one.
class PairRuns {
public:
    void add(std::span<const Pair> run) {
        if (!runs_.empty() && runs_.back().data() + runs_.back().size() == run.data()) {
            runs_.back() = {runs_.back().data(), runs_.back().size() + run.size()};
        } else if (!run.empty()) {
            runs_.push_back(run);
        }
    }
    void clear() { runs_.clear(); }
    std::span<const std::span<const Pair>> view() const { return runs_; }

private:
    std::vector<std::span<const Pair>> runs_;
};

/// Base class of outputs that process each pair, not only the number of pairs.
class FullOutput : public ShareWriter {
public:
    bool counting() const final { return false; }
    void write_count(std::uint64_t) final {
        throw Error(ErrorCode::engine_failed, "a step only counted pairs where the pairs themselves are needed");
    }
};

/// Counts the pairs of each share. `Place`: record(share, number of pairs); check(number of pairs so far), which may throw.
template <typename Place>
class CountOutput final : public ShareWriter {
public:
    explicit CountOutput(Place place) : place_(std::move(place)) {}
    template <typename Share>
    void begin(const Share&) {
        pairs_ = 0;
    }
    template <typename Share>
    void commit(const Share& share) {
        place_.record(share, pairs_);
    }
    bool counting() const override { return true; }
    void write(std::span<const Pair> pairs) override { write_count(pairs.size()); }
    void write_count(std::uint64_t pairs) override {
        pairs_ += pairs;
        place_.check(pairs_);
    }

private:
    Place place_;
    std::uint64_t pairs_ = 0;
};

/// Counts pairs by their `a`: adds the number of pairs of each bin to counts[bin]. Bin: the `a` of a pair without its low `bin_shift` bits.
/// Counts are visible before the commit of a share, so a lost share makes all of them wrong.
/// Thread safety: several outputs may share `counts`, also in shared memory; the additions are atomic.
template <typename Count>
class BinCountOutput final : public FullOutput {
public:
    explicit BinCountOutput(std::span<Count> counts, unsigned bin_shift = 0) : counts_(counts), bin_shift_(bin_shift) {}
    template <typename Share>
    void begin(const Share&) {}
    template <typename Share>
    void commit(const Share&) {}
    void write(std::span<const Pair> pairs) override {
        // Consecutive pairs are often of one bin: add a run of them with one atomic operation.
        for (std::size_t i = 0; i < pairs.size();) {
            const std::uint32_t bin = pairs[i].a >> bin_shift_;
            Count count = 0;
            while (i < pairs.size() && pairs[i].a >> bin_shift_ == bin) ++i, ++count;
            std::atomic_ref(counts_[bin]).fetch_add(count, std::memory_order_relaxed);
        }
    }

private:
    std::span<Count> counts_;
    unsigned bin_shift_;
};

/// Lists the pairs of each share. `Place`: take_block(pairs) returns memory for at least so many pairs; record(share, PairRuns).
template <typename Place>
class ListOutput final : public FullOutput {
public:
    explicit ListOutput(Place place) : place_(std::move(place)) {}
    template <typename Share>
    void begin(const Share&) {
        runs_.clear();
    }
    template <typename Share>
    void commit(const Share& share) {
        place_.record(share, runs_);
    }
    std::span<Pair> room(std::size_t pairs) override {
        if (block_.size() < pairs) {
            if (!block_.empty()) count_path(Path::list_block_full);
            block_ = place_.take_block(pairs);
        }
        return block_.first(pairs);
    }
    void write(std::span<const Pair> pairs) override {
        const std::span<Pair> to = room(pairs.size());
        if (to.data() != pairs.data()) std::copy(pairs.begin(), pairs.end(), to.begin());
        runs_.add(to);
        block_ = block_.subspan(pairs.size());
    }

private:
    Place place_;
    std::span<Pair> block_;  // free part of the current block
    PairRuns runs_;
};

/// Scatters pairs into buckets, from which BucketSort sorts them into ascending order. The buckets hold the pairs of all shares so far.
/// `Place`: pages() has memory for buckets; begin(buckets) is called before each share; record(share, buckets). Borrows the plan.
template <typename Place>
class AscendingOutput final : public FullOutput {
public:
    AscendingOutput(const BucketPlan& plan, Place place)
        : plan_(plan), place_(std::move(place)), buckets_(plan.buckets()) {}
    template <typename Share>
    void begin(const Share&) {
        place_.begin(buckets_);
    }
    template <typename Share>
    void commit(const Share& share) {
        place_.record(share, std::as_const(buckets_));
    }
    void write(std::span<const Pair> pairs) override { plan_.fill(pairs, buckets_, place_.pages()); }

    std::vector<PageString>& buckets() { return buckets_; }

private:
    const BucketPlan& plan_;
    Place place_;
    std::vector<PageString> buckets_;
};

/// Divides pairs into the parts that fit into blocks. room() returns how many pairs fit into the current block, at least 1, and makes room
/// before if there is none. put(part) appends a part to the block.
template <typename Room, typename Put>
void put_in_parts(std::span<const Pair> pairs, Room&& room, Put&& put) {
    while (!pairs.empty()) {
        const auto part = pairs.first(std::min<std::size_t>(pairs.size(), room()));
        put(part);
        pairs = pairs.subspan(part.size());
    }
}

}  // namespace octopair
