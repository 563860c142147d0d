// Pipeline: runs filters on the pairs of any engine. Pairs go in, collisions come out.
//
//     pairs -> [masks, exclusions] -> [exact object] -> [exact feature] -> collisions with contacts
//
// Order     The order of the engine's pairs (Options::order). The same bytes from every engine and for any number of threads.
// Memory    At most Options::buffer_bytes of pairs, and the findings of a part of them.
// Errors    octopair::Error. An exception of a filter or the sink ends the call and propagates to the caller.
// Ranks     With the MPI engine run() is collective, and each rank filters its own piece of the pairs. Options::limit must not
//           be set: a rank does not know how many collisions other ranks found. An exception of a filter may be thrown on its
//           rank only. filter() is not collective: it filters the pairs of the calling rank.
// Threads   Filters run in the caller's process, on several threads at once, each with its own batch. A pipeline makes one
//           call at a time.
// CMake     Link octopair::pipeline.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/collision.hpp"
#include "octopair/engine.hpp"
#include "octopair/input.hpp"

namespace [[gnu::visibility("default")]] octopair {

namespace detail {  // not for users
struct BatchAccess;
}

/// A batch of pairs that passes through the filters, in order, with the findings of the filters.
class Batch {
public:
    std::span<const Pair> pairs() const { return pairs_; }
    /// Returns one finding per pair; empty if no filter has stored a finding.
    std::span<const Finding> findings() const { return findings_; }

    /// Returns the finding of pair i, to be completed. The first call allocates findings for all pairs.
    Finding& finding(std::size_t i) {
        if (findings_.empty()) findings_.resize(pairs_.size());
        return findings_[i];
    }

    /// Keeps the pairs for which keep(i) is true, and their findings; drops the others. Calls `keep` in ascending order of i,
    /// the index before the call. `keep` may call finding(i). Throws: Error{cancelled} after a stop request.
    template <typename Keep>
    void keep_if(Keep keep) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            if (stop_.stop_requested()) cancel();
            if (!keep(i)) continue;
            if (kept != i) {
                pairs_[kept] = pairs_[i];
                if (!findings_.empty()) findings_[kept] = std::move(findings_[i]);
            }
            ++kept;
        }
        pairs_.resize(kept);
        if (!findings_.empty()) findings_.resize(kept);
    }

    /// Keeps the pairs with these indices, and their findings; drops the others. Requires: `numbers` is strictly ascending.
    /// Throws: Error{cancelled} after a stop request.
    void keep_these(std::span<const std::uint32_t> numbers) {
        if (stop_.stop_requested()) cancel();
        std::size_t kept = 0;
        for (const std::uint32_t i : numbers) {
            pairs_[kept] = pairs_[i];
            if (!findings_.empty() && kept != i) findings_[kept] = std::move(findings_[i]);
            ++kept;
        }
        pairs_.resize(kept);
        if (!findings_.empty()) findings_.resize(kept);
    }

    /// Counts a pair that the filter cannot decide (FilterCounts::undecided).
    void count_undecided() { ++undecided_; }

    /// Returns the stop token of the call. A filter that spends long on one pair should check it.
    const std::stop_token& stop() const { return stop_; }

private:
    friend struct detail::BatchAccess;
    [[noreturn]] static void cancel();

    std::vector<Pair> pairs_;
    std::vector<Finding> findings_;
    std::uint64_t undecided_ = 0;
    std::stop_token stop_;
};

/// One stage of the pipeline. To write your own filter, derive a class whose apply() calls batch.keep_if().
class Filter {
public:
    Filter() = default;
    Filter(const Filter&) = delete;
    Filter& operator=(const Filter&) = delete;
    virtual ~Filter() = default;

    /// Returns the name for the summary, for example "exact object".
    virtual std::string_view name() const = 0;
    /// Filters a batch. Requires: the effect on a pair depends only on that pair.
    /// Thread safety: several threads call this at once, with different batches.
    virtual void apply(Batch& batch) const = 0;
    /// Returns the minimum number of pairs per batch, for a filter whose time is mostly per call. The last batch may have fewer pairs.
    virtual std::size_t least_batch() const { return 1; }
};

/// Returns a filter that keeps the pairs for which `keep` returns true.
std::unique_ptr<Filter> make_filter(std::string name, std::function<bool(Pair)> keep);

struct FilterCounts {
    std::string name;
    std::uint64_t in = 0, out = 0;  ///< number of pairs before and after the filter
    double seconds = 0;             ///< sum over all threads
    /// Number of pairs that the filter could not decide. "exact object" drops them: an object lies in the bounds of a mesh that is not
    /// closed. Such a mesh has no inside, and the surfaces do not meet. "exact feature" keeps them as penetrating: ThicknessKind::undecided.
    std::uint64_t undecided = 0;
};

struct PipelineSummary {
    std::uint64_t collisions = 0;                                ///< number of pairs that passed all filters
    std::array<std::uint64_t, collision_classes> of_class = {};  ///< collisions with a finding, by class
    bool truncated = false;  ///< true if `limit` was reached and at least one more collision exists
    double seconds = 0;      ///< wall-clock time
    /// Summary of the all-pairs stage. Its seconds exclude the calling thread's work for filters and the sink. If the limit
    /// ended the search early, only pairs and seconds are valid.
    Summary search;
    std::vector<FilterCounts> filters;  ///< one element per filter, in pipeline order
};

/// Receives batches in order, on the calling thread. A batch is not empty and is valid only during the call. An exception ends
/// the search and propagates to the caller.
using CollisionSink = std::function<void(const Batch&)>;

class Pipeline {
public:
    /// Makes an empty pipeline that runs filters on `threads` threads; 0: one per core.
    /// Throws: Error{usage} for more than max_threads.
    explicit Pipeline(unsigned threads = 0);
    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    /// Appends a filter. Throws: Error{usage} if `filter` is null.
    void add(std::unique_ptr<Filter> filter);

    /// Finds pairs with the engine, filters them and passes the collisions to `sink`; an empty sink: only counts them.
    /// Filters and sinks that call `engine` get an Error{usage} (engine.hpp).
    /// `Options::limit` is the maximum number of collisions. `Options::verify` checks the engine's pairs, not the filters. If the limit
    /// ends the search early, it checks only the pairs found so far. Throws: as Engine::stream_pairs().
    PipelineSummary run(Engine& engine, const Input& input, const CollisionSink& sink, const Options& options = {},
                        std::stop_token stop = {});
    /// Filters the given pairs in their order. Uses only `limit`, `buffer_bytes` and `progress` of the options.
    PipelineSummary filter(const PairList& pairs, const CollisionSink& sink, const Options& options = {},
                           std::stop_token stop = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
