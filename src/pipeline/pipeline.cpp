// Pipeline: an engine's pairs, gathered into blocks, through all filters and in order to the sink.
//
// Blocks are as long as keeps a thread busy for a moment: one pair where a pair takes long, so that threads share the work
// to its end; thousands where a pair costs nothing, so that handing blocks about costs less. The result does not depend on it:
// a filter judges each pair by itself.
#include <algorithm>
#include <chrono>
#include <new>
#include <thread>
#include <utility>

#include "base/floating_point.hpp"
#include "base/timed.hpp"
#include "octopair/error.hpp"
#include "pipeline/batch_access.hpp"
#include "pipeline/block_row.hpp"

namespace octopair {

namespace {

using Filters = std::vector<std::unique_ptr<Filter>>;

/// Thrown through an engine's search when enough has come out.
struct Enough {};

/// How many pairs the next block should have.
class BlockSize {
public:
    explicit BlockSize(std::size_t most) : most_(most), pairs_(std::min<std::size_t>(first, most)) {}

    std::size_t pairs() const { return pairs_; }

    /// A block of so many pairs took so long.
    void learn(std::uint64_t pairs, double seconds) {
        if (pairs == 0) return;
        const double a_pair = seconds / double(pairs);
        seconds_ = seconds_ < 0 ? a_pair : 0.75 * seconds_ + 0.25 * a_pair;
        const double fitting = aim / std::max(seconds_, 1e-12);
        pairs_ = std::size_t(std::clamp(fitting, 1.0, double(most_)));
    }

private:
    static constexpr std::size_t first = 64;
    static constexpr double aim = 2e-4;  // seconds; far more than it takes to hand a block over

    std::size_t most_, pairs_;
    double seconds_ = -1;  // of a pair, lately
};

/// One call's way from the engine's sink to the caller's. Everything but apply() runs on the calling thread.
class Flow {
public:
    struct Setup {
        const Filters& filters;
        unsigned threads;
        const CollisionSink& sink;
        const Options& options;
        std::stop_token stop;
    };

    Flow(const Setup& setup, PipelineSummary& summary)
        : filters_(setup.filters),
          sink_(setup.sink),
          summary_(summary),
          left_(setup.options.limit.value_or(~std::uint64_t(0))),
          size_(most_pairs(setup)),
          forward_(setup.stop, Forward{abandon_}),
          row_(
              setup.threads, [this](Block& block) { apply(block); }, [this](Block& block) { deliver(block); }) {}
    Flow(const Flow&) = delete;
    Flow& operator=(const Flow&) = delete;
    ~Flow() { abandon_.request_stop(); }

    /// Pairs in all blocks together; a fourth of the buffer at most.
    static std::uint64_t held_pairs(const Setup& setup) { return most_pairs(setup) * BlockRow::length(setup.threads); }

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
        row_.hand_out();
    }

    void finish() {
        const Timed timed(seconds_);
        if (filling_ != nullptr) end_block();
        row_.finish();
    }

    /// On the calling thread.
    double seconds() const { return seconds_; }

private:
    struct Forward {
        std::stop_source& abandon;
        void operator()() const { abandon.request_stop(); }
    };

    static std::size_t most_pairs(const Setup& setup) {
        const std::uint64_t pairs = std::max<std::uint64_t>(setup.options.buffer_bytes, 1 << 20) / sizeof(Pair) / 4;
        return std::size_t(std::clamp<std::uint64_t>(pairs / BlockRow::length(setup.threads), 1, 4096));
    }

    void begin_block() {
        filling_ = &row_.room();
        detail::BatchAccess::restart(filling_->batch, abandon_.get_token());
        goal_ = size_.pairs();
    }

    void end_block() {
        filling_ = nullptr;
        row_.add();
    }

    /// On any thread.
    void apply(Block& block) const {
        block.work.assign(filters_.size(), {});
        for (std::size_t i = 0; i < filters_.size(); ++i) {
            FilterWork& work = block.work[i];
            work.in = block.batch.pairs().size();
            if (work.in == 0) return;
            const Timed timed(work.seconds);
            filters_[i]->apply(block.batch);
            work.out = block.batch.pairs().size();
            // What a filter says after a stop request need not be true.
            if (block.batch.stop().stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
        }
    }

    void deliver(Block& block) {
        count(block);
        Batch& batch = block.batch;
        const bool too_many = batch.pairs().size() > left_;
        if (too_many) detail::BatchAccess::cut(batch, std::size_t(left_));
        left_ -= batch.pairs().size();
        summary_.collisions += batch.pairs().size();
        if (sink_ && !batch.pairs().empty()) sink_(batch);
        if (too_many) {
            summary_.truncated = true;
            throw Enough{};
        }
    }

    void count(const Block& block) {
        double seconds = 0;
        for (std::size_t i = 0; i < block.work.size(); ++i) {
            FilterCounts& counts = summary_.filters[i];
            counts.in += block.work[i].in;
            counts.out += block.work[i].out;
            counts.seconds += block.work[i].seconds;
            seconds += block.work[i].seconds;
        }
        if (!block.work.empty()) size_.learn(block.work[0].in, seconds);
    }

    const Filters& filters_;
    const CollisionSink& sink_;
    PipelineSummary& summary_;
    std::uint64_t left_;  // of the limit
    BlockSize size_;
    double seconds_ = 0;
    Block* filling_ = nullptr;
    std::size_t goal_ = 0;  // of the block that is being filled
    std::stop_source abandon_;
    std::stop_callback<Forward> forward_;
    BlockRow row_;  // the last, so that its helpers end before what they use
};

/// Some pairs at a time, so that progress is told and what is done is handed out meanwhile. An empty sink counts.
Summary give(const PairList& pairs, const PairSink& take, const Options& options) {
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

    /// What every call becomes; `search` asks the engine.
    template <typename Search>
    PipelineSummary run(const CollisionSink& sink, const Options& options, const std::stop_token& stop,
                        const Search& search) const {
        const FloatingPointScope scope;
        PipelineSummary summary;
        for (const auto& filter : filters) summary.filters.push_back({std::string(filter->name())});
        try {
            const Timed timed(summary.seconds);
            if (filters.empty() && !sink) {
                summary.search = search(PairSink{}, options);
                summary.collisions = summary.search.pairs;
                summary.truncated = summary.search.truncated;
            } else {
                filter({filters, threads, sink, options, stop}, search, summary);
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
            // The end is told when filters have seen all.
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
        } catch (const Enough&) {
        }
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        const double elsewhere = flow.seconds() + summary.search.verification.seconds;
        summary.search.seconds = std::max(0.0, passed.count() - elsewhere);
        if (setup.options.progress) setup.options.progress(1);
    }
};

Pipeline::Pipeline(unsigned threads)
    : state_(std::make_unique<State>(threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency()))) {}

Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

void Pipeline::add(std::unique_ptr<Filter> filter) {
    if (filter == nullptr) throw Error(ErrorCode::usage, "a pipeline is given no filter");
    state_->filters.push_back(std::move(filter));
}

// NOLINTNEXTLINE(readability-function-size): the public face has these five.
PipelineSummary Pipeline::run(Engine& engine, const Input& input, const CollisionSink& sink, const Options& options,
                              std::stop_token stop) {
    return state_->run(sink, options, stop, [&](const PairSink& take, const Options& passed) {
        return engine.stream_pairs(input, take, passed, stop);
    });
}

PipelineSummary Pipeline::filter(const PairList& pairs, const CollisionSink& sink, const Options& options,
                                 std::stop_token stop) {
    return state_->run(sink, options, stop,
                       [&](const PairSink& take, const Options& passed) { return give(pairs, take, passed); });
}

}  // namespace octopair
