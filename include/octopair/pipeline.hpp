// The pipeline: filters in a row behind any engine. Pairs go in, collisions come out.
//
//     pairs -> [masks, exclusions] -> [exact object] -> [exact feature] -> collisions with contacts
//
// Order     that of the engine's pairs (Options::order); the same bytes for any number of threads and from every engine.
// Memory    bounded by the batch: at most Options::buffer_bytes of pairs are held, and what filters learned of a part of
//           them.
// Errors    octopair::Error; what a filter or the sink throws ends the call and reaches the caller.
// Ranks     behind the MPI engine run() is collective, and each rank has what comes out of its own piece: with no limit,
//           which none can heed alone, and what a filter throws may be thrown on its rank alone. filter(), of a piece that
//           was found before, asks no other rank.
// Threads   filters run in the caller's process, on several threads at once, each with its own batch; one pipeline makes
//           one call at a time. CMake: link octopair::pipeline.
#pragma once

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

namespace octopair {

namespace detail {  // not for users
struct BatchAccess;
}

/// Some pairs on their way through the filters, in order.
class Batch {
public:
    std::span<const Pair> pairs() const { return pairs_; }
    /// What is known of each pair: as many as there are pairs, or none if no filter has learned anything.
    std::span<const Finding> findings() const { return findings_; }

    /// What is known of a pair, to be added to. Finding places are made for all pairs at the first call.
    Finding& finding(std::size_t i) {
        if (findings_.empty()) findings_.resize(pairs_.size());
        return findings_[i];
    }

    /// Lets pairs through for which keep(i) is true, with what is known of them. Called in order of i, which counts in
    /// the batch as it was before; `keep` may call finding(i). Throws Error{cancelled} after a stop request.
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

    /// Lets through the pairs of these numbers, which ascend, with what is known of them.
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

    /// For filters that take long over one pair.
    const std::stop_token& stop() const { return stop_; }

private:
    friend struct detail::BatchAccess;
    [[noreturn]] static void cancel();

    std::vector<Pair> pairs_;
    std::vector<Finding> findings_;
    std::stop_token stop_;
};

/// One stage of the pipeline. A user's own: a class with a name, and an apply() that calls batch.keep_if().
class Filter {
public:
    Filter() = default;
    Filter(const Filter&) = delete;
    Filter& operator=(const Filter&) = delete;
    virtual ~Filter() = default;

    /// For the summary: "exact object".
    virtual std::string_view name() const = 0;
    /// Called by several threads at once, with different batches. What it does to a pair must depend on that pair alone.
    virtual void apply(Batch& batch) const = 0;
};

/// A filter made of a condition that a pair has to meet.
std::unique_ptr<Filter> make_filter(std::string name, std::function<bool(Pair)> keep);

struct FilterCounts {
    std::string name;
    std::uint64_t in = 0, out = 0;
    double seconds = 0;  ///< of all threads together
};

struct PipelineSummary {
    std::uint64_t collisions = 0;  ///< what came out
    bool truncated = false;        ///< `limit` was reached and at least one more collision exists
    double seconds = 0;            ///< wall clock
    /// Of the all-pairs stage, without what the calling thread did for filters and in the sink meanwhile. Where the limit
    /// ended it early, its pairs and seconds alone are known.
    Summary search;
    std::vector<FilterCounts> filters;
};

/// Receives batches in order, on the calling thread; a batch is valid during the call only, and not empty. What it throws
/// ends the call and reaches the caller.
using CollisionSink = std::function<void(const Batch&)>;

class Pipeline {
public:
    /// `threads`: for the filters; 0: one per core.
    explicit Pipeline(unsigned threads = 0);
    Pipeline(Pipeline&&) noexcept;
    Pipeline& operator=(Pipeline&&) noexcept;
    ~Pipeline();

    /// Behind those that are there.
    void add(std::unique_ptr<Filter> filter);

    /// Finds pairs with the engine and filters them; `limit` counts what comes out. An empty sink has it counted only.
    /// `verify` checks the engine's pairs, not the filters; where `limit` ends the search early, no more than those that
    /// were found.
    PipelineSummary run(Engine& engine, const Input& input, const CollisionSink& sink, const Options& options = {},
                        std::stop_token stop = {});
    /// Pairs that are there already, in their order; of the options it heeds limit, buffer_bytes and progress.
    PipelineSummary filter(const PairList& pairs, const CollisionSink& sink, const Options& options = {},
                           std::stop_token stop = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
