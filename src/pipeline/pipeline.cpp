// Pipeline: gathers an engine's pairs into blocks, applies all filters, and passes the results to the sink in order.
//
// The size of blocks follows the measured time of a pair. A block has one pair if a pair takes long, so that all threads
// have work until the end. It has thousands if pairs are cheap, so that passing blocks between threads costs little.
// The result does not depend on the size, because a filter judges each pair by itself.
#include <algorithm>
#include <chrono>
#include <new>
#include <utility>

#include "base/call_scope.hpp"
#include "base/floating_point_scope.hpp"
#include "base/timed.hpp"
#include "octopair/error.hpp"
#include "parallel/team.hpp"
#include "pipeline/batch_access.hpp"
#include "pipeline/block_ring.hpp"

namespace octopair {

namespace {

using Filters = std::vector<std::unique_ptr<Filter>>;

/// Exception that ends an engine's search: Options::limit collisions have been delivered, and one more was found.
struct LimitReached {};

/// Chooses the number of pairs of the next block from measured times. The first block is as small as the filters allow.
class BlockSize {
public:
    BlockSize(std::size_t least, std::size_t most) : least_(std::min(least, most)), most_(most), pairs_(least_) {}

    std::size_t pairs() const { return pairs_; }

    /// Adds a measurement: a block of `pairs` pairs took `seconds`.
    void learn(std::uint64_t pairs, double seconds) {
        if (pairs == 0) return;
        const double a_pair = seconds / double(pairs);
        seconds_ = seconds_ < 0 ? a_pair : 0.75 * seconds_ + 0.25 * a_pair;
        const double fitting = std::min(aim / std::max(seconds_, 1e-12), double(measured_ == 0 ? few : most_));
        pairs_ = std::size_t(std::clamp(fitting, double(least_), double(most_)));
        measured_ += pairs;
    }

    bool is_measured() const { return measured_ > 0; }

private:
    static constexpr std::size_t few = 64;  // after one pair, which may be easier than others
    static constexpr double aim = 2e-4;     // intended seconds for a block; passing it to a thread takes far less

    std::size_t least_, most_, pairs_;
    double seconds_ = -1;         // moving average of the time for a pair; negative: not measured yet
    std::uint64_t measured_ = 0;  // number of pairs measured
};

/// One call. Takes pairs as the engine's sink, applies the filters, and passes the results to the caller's sink. apply() runs on several
/// threads, all other functions on the calling thread.
class Flow {
public:
    struct Setup {
        const Engine* engine;  // null for a list of pairs
        const Filters& filters;
        unsigned threads;
        const CollisionSink& sink;
        const Options& options;
        std::stop_token stop;
    };

    Flow(const Setup& setup, PipelineSummary& summary)
        : engine_(setup.engine),
          filters_(setup.filters),
          sink_(setup.sink),
          summary_(summary),
          left_(setup.options.limit.value_or(~std::uint64_t(0))),
          size_(least_block_pairs(setup), max_block_pairs(setup)),
          forward_(setup.stop, Forward{abandon_}),
          ring_(
              setup.threads, [this](Block& block) { apply(block); }, [this](Block& block) { deliver(block); }) {}
    Flow(const Flow&) = delete;
    Flow& operator=(const Flow&) = delete;
    ~Flow() { abandon_.request_stop(); }

    /// Returns the maximum number of pairs in all blocks. They use at most a quarter of Options::buffer_bytes, or 256 KiB.
    static std::uint64_t held_pairs(const Setup& setup) {
        return max_block_pairs(setup) * BlockRing::length(setup.threads);
    }

    void take(std::span<const Pair> pairs) {
        const Timed timed(seconds_);
        summary_.search.pairs += pairs.size();
        while (!pairs.empty()) {
            if (filling_ == nullptr) begin_block();
            const std::size_t held = filling_->batch.pairs().size();
            const auto some = pairs.first(std::min(pairs.size(), goal_ - held));
            detail::BatchAccess::append(filling_->batch, some);
            pairs = pairs.subspan(some.size());
            if (held + some.size() == goal_) end_block();
        }
        ring_.hand_out();
    }

    void finish() {
        const Timed timed(seconds_);
        if (filling_ != nullptr) end_block();
        ring_.finish();
    }

    /// Returns the time spent in take() and finish(), on the calling thread.
    double seconds() const { return seconds_; }

private:
    struct Forward {
        std::stop_source& abandon;
        void operator()() const { abandon.request_stop(); }
    };

    static std::size_t max_block_pairs(const Setup& setup) {
        const std::uint64_t pairs = std::max<std::uint64_t>(setup.options.buffer_bytes, 1 << 20) / sizeof(Pair) / 4;
        return std::size_t(std::clamp<std::uint64_t>(pairs / BlockRing::length(setup.threads), 1, 4096));
    }

    static std::size_t least_block_pairs(const Setup& setup) {
        std::size_t least = 1;
        for (const auto& filter : setup.filters) least = std::max(least, filter->least_batch());
        return least;
    }

    void begin_block() {
        filling_ = &ring_.empty_block();
        detail::BatchAccess::restart(filling_->batch, abandon_.get_token());
        goal_ = size_.pairs();
    }

    void end_block() {
        filling_ = nullptr;
        ring_.add();
        // The first pair tells whether few pairs are worth several threads.
        if (!size_.is_measured()) ring_.finish();
    }

    /// Applies all filters to a block. Runs on any thread.
    void apply(Block& block) const {
        const CallScope callback(engine_, outer_);
        block.work.assign(filters_.size(), {});
        for (std::size_t i = 0; i < filters_.size(); ++i) {
            FilterWork& work = block.work[i];
            work.in = block.batch.pairs().size();
            if (work.in == 0) return;
            const Timed timed(work.seconds);
            filters_[i]->apply(block.batch);
            work.out = block.batch.pairs().size();
            work.undecided = detail::BatchAccess::take_undecided(block.batch);
            // A filter may return wrong results after a stop request.
            if (block.batch.stop().stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
        }
    }

    void deliver(Block& block) {
        const CallScope callback(engine_, outer_);
        count(block);
        Batch& batch = block.batch;
        const bool too_many = batch.pairs().size() > left_;
        if (too_many) detail::BatchAccess::cut(batch, std::size_t(left_));
        left_ -= batch.pairs().size();
        summary_.collisions += batch.pairs().size();
        for (const Finding& finding : batch.findings()) ++summary_.of_class[std::size_t(finding.collision_class)];
        if (sink_ && !batch.pairs().empty()) sink_(batch);
        if (too_many) {
            summary_.truncated = true;
            throw LimitReached{};
        }
    }

    void count(const Block& block) {
        double seconds = 0;
        for (std::size_t i = 0; i < block.work.size(); ++i) {
            FilterCounts& counts = summary_.filters[i];
            counts.in += block.work[i].in;
            counts.out += block.work[i].out;
            counts.seconds += block.work[i].seconds;
            counts.undecided += block.work[i].undecided;
            seconds += block.work[i].seconds;
        }
        size_.learn(block.work.empty() ? block.batch.pairs().size() : block.work[0].in, seconds);
    }

    const Engine* engine_;
    const CallScope* outer_ = CallScope::innermost();  // innermost call whose callback runs this pipeline, if any
    const Filters& filters_;
    const CollisionSink& sink_;
    PipelineSummary& summary_;
    std::uint64_t left_;  // collisions that the limit still allows
    BlockSize size_;
    double seconds_ = 0;
    Block* filling_ = nullptr;
    std::size_t goal_ = 0;  // number of pairs at which the current block is full
    std::stop_source abandon_;
    std::stop_callback<Forward> forward_;
    BlockRing ring_;  // last, so that its helpers end before the members that they use are destroyed
};

/// Passes the pairs of a list to `take` in parts, and reports progress after each. With an empty `take`, only counts pairs.
Summary stream_list(const PairList& pairs, const PairSink& take, const Options& options) {
    constexpr std::size_t some = 1 << 16;
    Summary summary;
    summary.pairs = std::min(pairs.size(), options.limit.value_or(pairs.size()));
    summary.truncated = summary.pairs < pairs.size();
    if (!take) return summary;
    std::uint64_t given = 0;
    for (std::span<const Pair> chunk : pairs.chunks()) {
        while (!chunk.empty()) {
            const auto part = chunk.first(std::min(chunk.size(), some));
            take(part);
            chunk = chunk.subspan(part.size());
            given += part.size();
            if (options.progress) options.progress(double(given) / double(summary.pairs));
        }
    }
    return summary;
}

}  // namespace

void Batch::cancel() { throw Error(ErrorCode::cancelled, "cancelled"); }

struct Pipeline::State {
    unsigned threads;
    Filters filters = {};

    /// Returns the setup of a call. `engine`: engine of the search; null for a list of pairs.
    // NOLINTNEXTLINE(readability-function-size): an engine, and the parameters of Pipeline::run.
    Flow::Setup setup(const Engine* engine, const CollisionSink& sink, const Options& options,
                      std::stop_token stop) const {
        return {engine, filters, threads, sink, options, std::move(stop)};
    }

    /// Runs a call. `search(take, options)` passes all candidate pairs to `take`.
    template <typename Search>
    PipelineSummary run(const Flow::Setup& setup, const Search& search) const {
        const FloatingPointScope scope;
        PipelineSummary summary;
        for (const auto& filter : filters) summary.filters.push_back({std::string(filter->name())});
        try {
            const Timed timed(summary.seconds);
            if (filters.empty() && !setup.sink) {
                summary.search = search(PairSink{}, setup.options);
                summary.collisions = summary.search.pairs;
                summary.truncated = summary.search.truncated;
            } else {
                filter(setup, search, summary);
            }
        } catch (const std::bad_alloc&) {
            throw Error(ErrorCode::resource_limit, "out of memory");
        }
        return summary;
    }

private:
    template <typename Search>
    static void filter(const Flow::Setup& setup, const Search& search, PipelineSummary& summary) {
        Options options = setup.options;
        options.limit.reset();
        options.buffer_bytes -= std::min(options.buffer_bytes, Flow::held_pairs(setup) * sizeof(Pair));
        if (setup.options.progress) {
            // Progress 1 is reported when the filters have processed all pairs.
            options.progress = [&](double done) {
                if (done < 1) setup.options.progress(done);
            };
        }
        const auto begin = std::chrono::steady_clock::now();
        Flow flow(setup, summary);
        const PairSink take = [&](std::span<const Pair> pairs) { flow.take(pairs); };
        try {
            summary.search = search(take, options);
            flow.finish();
        } catch (const LimitReached&) {
        }
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        const double elsewhere = flow.seconds() + summary.search.verification.seconds;
        summary.search.seconds = std::max(0.0, passed.count() - elsewhere);
        if (setup.options.progress) setup.options.progress(1);
    }
};

Pipeline::Pipeline(unsigned threads) : state_(std::make_unique<State>(thread_count(threads))) {}

Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

void Pipeline::add(std::unique_ptr<Filter> filter) {
    if (filter == nullptr) throw Error(ErrorCode::usage, "Pipeline::add: the filter is null");
    state_->filters.push_back(std::move(filter));
}

// NOLINTNEXTLINE(readability-function-size): the public function has these five parameters.
PipelineSummary Pipeline::run(Engine& engine, const Input& input, const CollisionSink& sink, const Options& options,
                              std::stop_token stop) {
    return state_->run(state_->setup(&engine, sink, options, stop), [&](const PairSink& take, const Options& passed) {
        return engine.stream_pairs(input, take, passed, stop);
    });
}

PipelineSummary Pipeline::filter(const PairList& pairs, const CollisionSink& sink, const Options& options,
                                 std::stop_token stop) {
    return state_->run(state_->setup(nullptr, sink, options, stop),
                       [&](const PairSink& take, const Options& passed) { return stream_list(pairs, take, passed); });
}

}  // namespace octopair
