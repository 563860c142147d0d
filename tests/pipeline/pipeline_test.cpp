// Tests pipelines against plain loops over all pairs: output, order, limit and counters.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

std::vector<Pair> engine_pairs(const std::vector<Box3f>& boxes, Order order) {
    Options options{.order = order};
    return find_pairs(boxes, options);
}

/// Returns the expected output of two filters for the engine's pairs.
Outcome expected_of(const std::vector<Pair>& pairs) {
    Outcome outcome;
    for (const Pair pair : pairs) {
        if (pair.a % 7 == 3 || lot(pair) % 3 == 0) continue;
        outcome.pairs.push_back(pair);
        outcome.notes.push_back(lot(pair));
    }
    return outcome;
}

Pipeline two_filters(unsigned threads) {
    Pipeline pipeline(threads);
    pipeline.add(make_filter("sevenths", [](Pair pair) { return pair.a % 7 != 3; }));
    pipeline.add(std::make_unique<LotFilter>(3));
    return pipeline;
}

struct Arrangement {
    unsigned threads;
    Order order;
    std::uint64_t buffer_bytes;
};

std::vector<Arrangement> arrangements() {
    std::vector<Arrangement> all;
    for (const unsigned threads : {1u, 2u, 7u}) {
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const std::uint64_t buffer : {1u << 20, 1u << 30}) all.push_back({threads, order, buffer});
        }
    }
    return all;
}

class AnyPipeline : public ::testing::TestWithParam<Arrangement> {
protected:
    Options options() const {
        Options options{.order = GetParam().order, .buffer_bytes = GetParam().buffer_bytes};
        return options;
    }
};

std::string arrangement_name_of(const ::testing::TestParamInfo<Arrangement>& info) {
    return std::to_string(info.param.threads) + (info.param.order == Order::octal ? "Octal" : "Ascending") +
           (info.param.buffer_bytes > 1 << 20 ? "Large" : "Small");
}

INSTANTIATE_TEST_SUITE_P(, AnyPipeline, ::testing::ValuesIn(arrangements()), arrangement_name_of);

TEST_P(AnyPipeline, LetsThroughWhatAPlainLoopDoes) {
    const auto boxes = samples::make_scene("dense", 40'000, 1);  // more pairs than a small buffer holds
    const auto pairs = engine_pairs(boxes, GetParam().order);
    const Outcome expected = expected_of(pairs);
    const auto engine = make_local_engine(GetParam().threads);
    Pipeline pipeline = two_filters(GetParam().threads);
    for (int again = 0; again < 2; ++again) {
        Outcome found;
        const PipelineSummary summary = pipeline.run(*engine, all_of(boxes), into(found), options());
        expect_same(found, expected);
        EXPECT_EQ(summary.collisions, expected.pairs.size());
        EXPECT_FALSE(summary.truncated);
        EXPECT_EQ(summary.search.pairs, pairs.size());
        ASSERT_EQ(summary.filters.size(), 2u);
        EXPECT_EQ(summary.filters[0].name, "sevenths");
        EXPECT_EQ(summary.filters[0].in, pairs.size());
        EXPECT_EQ(summary.filters[1].in, summary.filters[0].out);
        EXPECT_EQ(summary.filters[1].out, expected.pairs.size());
        EXPECT_GT(summary.filters[1].seconds, 0);
        EXPECT_EQ(pipeline.run(*engine, all_of(boxes), {}, options()).collisions, expected.pairs.size());
    }
}

TEST_P(AnyPipeline, LimitsWhatComesOut) {
    const auto boxes = samples::make_scene("dense", 60, 3);
    const Outcome all = expected_of(engine_pairs(boxes, GetParam().order));
    ASSERT_GT(all.pairs.size(), 20u);
    const auto engine = make_local_engine(2);
    Pipeline pipeline = two_filters(GetParam().threads);
    for (std::size_t limit = 0; limit <= all.pairs.size() + 1; ++limit) {
        SCOPED_TRACE(limit);
        Options limited = options();
        limited.limit = limit;
        Outcome found;
        const PipelineSummary summary = pipeline.run(*engine, all_of(boxes), into(found), limited);
        const std::size_t kept = std::min(limit, all.pairs.size());
        EXPECT_EQ(summary.truncated, limit < all.pairs.size());
        EXPECT_EQ(summary.collisions, kept);
        EXPECT_TRUE(std::ranges::equal(found.pairs, std::span(all.pairs).first(kept)));
        EXPECT_TRUE(std::ranges::equal(found.notes, std::span(all.notes).first(kept)));
    }
}

TEST_P(AnyPipeline, JoinsTwoSets) {
    const auto first = samples::make_scene("dense", 3000, 1), second = samples::make_scene("dense", 2000, 2);
    Options asked = options();
    asked.margin = 0.01;
    PairList list;
    const auto engine = make_local_engine(2);
    engine->find_pairs(Join{all_of(first), all_of(second)}, list, asked);
    const Outcome expected = expected_of(list.to_vector());
    ASSERT_GT(expected.pairs.size(), 1000u);
    Outcome found;
    Pipeline pipeline = two_filters(GetParam().threads);
    pipeline.run(*engine, Join{all_of(first), all_of(second)}, into(found), asked);
    expect_same(found, expected);
}

TEST_P(AnyPipeline, ReportsItsProgress) {
    const auto boxes = samples::make_scene("dense", 20'000, 1);
    Options asked = options();
    std::vector<double> told;
    std::mutex telling;  // progress may be called on another thread than the sink
    asked.progress = [&](double done) {
        const std::lock_guard lock(telling);
        told.push_back(done);
    };
    bool ended_early = false;
    const CollisionSink sink = [&](const Batch&) {
        const std::lock_guard lock(telling);
        ended_early |= !told.empty() && told.back() >= 1;
    };
    Pipeline pipeline = two_filters(GetParam().threads);
    pipeline.run(*make_local_engine(2), all_of(boxes), sink, asked);
    EXPECT_FALSE(ended_early);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    ASSERT_FALSE(told.empty());
    EXPECT_EQ(told.back(), 1.0);
    // Progress is also reported while filters run.
    EXPECT_GT(std::ranges::count_if(told, [](double done) { return done > 0.65 && done < 1; }), 3);
}

TEST(Pipeline, WithoutFiltersIsTheEngine) {
    const auto boxes = samples::make_scene("dense", 2000, 1);
    const auto pairs = engine_pairs(boxes, Order::ascending);
    const auto engine = make_local_engine(2);
    Pipeline pipeline(2);
    Outcome found;
    EXPECT_EQ(pipeline.run(*engine, all_of(boxes), into(found)).collisions, pairs.size());
    EXPECT_TRUE(same_sequence(found.pairs, pairs));
    EXPECT_TRUE(found.notes.empty());
    Options limited{.limit = 10};
    const PipelineSummary counted = pipeline.run(*engine, all_of(boxes), {}, limited);
    EXPECT_EQ(counted.collisions, 10u);
    EXPECT_TRUE(counted.truncated);
    EXPECT_THROW(pipeline.add(nullptr), Error);
}

/// Keeps the pairs of a batch whose lot is even, by their positions in the batch.
class OtherFilter final : public Filter {
public:
    std::string_view name() const override { return "others"; }
    void apply(Batch& batch) const override {
        std::vector<std::uint32_t> numbers;
        for (std::uint32_t i = 0; i < batch.pairs().size(); ++i) {
            if (lot(batch.pairs()[i]) % 2 == 0) numbers.push_back(i);
        }
        batch.keep_these(numbers);
    }
};

TEST(Pipeline, KeepsPairsByNumberWithWhatIsKnownOfThem) {
    const auto boxes = samples::make_scene("dense", 20'000, 1);
    const auto engine = make_local_engine(1);
    Outcome before, found, expected;
    Pipeline pipeline(2);
    pipeline.add(std::make_unique<LotFilter>(3));
    pipeline.run(*engine, all_of(boxes), into(before));
    pipeline.add(std::make_unique<OtherFilter>());
    pipeline.run(*engine, all_of(boxes), into(found));
    for (std::size_t i = 0; i < before.pairs.size(); ++i) {
        if (lot(before.pairs[i]) % 2 != 0) continue;
        expected.pairs.push_back(before.pairs[i]);
        expected.notes.push_back(before.notes[i]);
    }
    EXPECT_FALSE(expected.pairs.empty());
    expect_same(found, expected);
}

TEST_P(AnyPipeline, FiltersPairsThatAreThere) {
    const auto boxes = samples::make_scene("dense", 20'000, 5);
    PairList pairs;
    make_local_engine(2)->find_pairs(all_of(boxes), pairs, options());
    const Outcome expected = expected_of(pairs.to_vector());
    Pipeline pipeline = two_filters(GetParam().threads);
    Options asked = options();
    double last = 0;
    asked.progress = [&](double done) {
        EXPECT_GE(done, last);
        last = done;
    };
    Outcome found;
    const PipelineSummary summary = pipeline.filter(pairs, into(found), asked);
    expect_same(found, expected);
    EXPECT_EQ(summary.collisions, expected.pairs.size());
    EXPECT_FALSE(summary.truncated);
    EXPECT_EQ(summary.search.pairs, pairs.size());
    EXPECT_EQ(summary.filters.front().in, pairs.size());
    EXPECT_EQ(last, 1);
    asked.progress = {};
    asked.limit = 1234;
    Outcome few;
    EXPECT_TRUE(pipeline.filter(pairs, into(few), asked).truncated);
    EXPECT_TRUE(std::ranges::equal(few.pairs, std::span(expected.pairs).first(1234)));
}

TEST(Pipeline, CountsPairsThatAreThere) {
    const auto boxes = samples::make_scene("dense", 5000, 1);
    PairList pairs;
    EXPECT_EQ(Pipeline(2).filter(pairs, {}).collisions, 0u);
    make_local_engine(2)->find_pairs(all_of(boxes), pairs);
    EXPECT_EQ(Pipeline(2).filter(pairs, {}).collisions, pairs.size());
    const PipelineSummary limited = Pipeline(2).filter(pairs, {}, {.limit = 7});
    EXPECT_EQ(limited.collisions, 7u);
    EXPECT_TRUE(limited.truncated);
    Outcome none;
    EXPECT_THROW(two_filters(2).filter(pairs, into(none), {}, requested_stop()), Error);
    EXPECT_TRUE(none.pairs.empty());
}

TEST(Pipeline, BatchesAreNeverEmpty) {
    const auto boxes = samples::make_scene("dense", 5000, 1);
    Pipeline pipeline(2);
    pipeline.add(make_filter("few", [](Pair pair) { return pair.a == 17; }));
    std::size_t empty = 0, seen = 0;
    pipeline.run(*make_local_engine(2), all_of(boxes), [&](const Batch& batch) {
        empty += batch.pairs().empty();
        seen += batch.pairs().size();
    });
    EXPECT_EQ(empty, 0u);
    EXPECT_GT(seen, 0u);
}

/// Keeps everything, slowly, and counts the batches that are smaller than it asks for.
class SlowCallFilter final : public Filter {
public:
    SlowCallFilter(std::size_t least, std::atomic<int>& small) : least_(least), small_(small) {}
    std::string_view name() const override { return "slow call"; }
    std::size_t least_batch() const override { return least_; }
    void apply(Batch& batch) const override {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (batch.pairs().size() < 200) ++small_;
    }

private:
    std::size_t least_;
    std::atomic<int>& small_;
};

TEST(Pipeline, BatchesAreAsLargeAsAFilterAsks) {
    const std::vector<Box3f> boxes(60);  // 1,770 pairs
    const auto engine = make_local_engine(1);
    const auto small_batches = [&](std::size_t least) {
        std::atomic<int> small = 0;
        Pipeline pipeline(2);
        pipeline.add(std::make_unique<SlowCallFilter>(least, small));
        EXPECT_EQ(pipeline.run(*engine, {boxes}, {}).collisions, 1770u);
        return small.load();
    };
    EXPECT_LE(small_batches(200), 1);  // the last batch
    EXPECT_GT(small_batches(1), 20);
    EXPECT_LE(small_batches(std::size_t(1) << 40), 1);
}

TEST(Pipeline, SinkIsCalledOnTheCallingThread) {
    const auto boxes = samples::make_scene("dense", 5000, 1);
    Pipeline pipeline = two_filters(4);
    std::set<std::thread::id> callers;
    pipeline.run(*make_local_engine(4), all_of(boxes),
                 [&](const Batch&) { callers.insert(std::this_thread::get_id()); });
    EXPECT_EQ(callers, std::set{std::this_thread::get_id()});
}

/// Holds each batch but the first, whose time is measured alone, until `threads` batches are held at the same time, or until a timeout of
/// 60 seconds.
class Meeting final : public Filter {
public:
    explicit Meeting(unsigned threads) : threads_(threads) {}
    std::string_view name() const override { return "meeting"; }
    void apply(Batch& batch) const override {
        std::unique_lock lock(mutex_);
        if (std::exchange(first_, false))
            return std::this_thread::sleep_for(std::chrono::milliseconds(1));  // pairs are costly
        ++present_;
        if (present_ >= threads_) met_ = true;
        changed_.notify_all();
        const auto over = [&] { return met_ || alone_; };
        if (!changed_.wait_for(lock, std::chrono::seconds(60), over)) alone_ = true;
        --present_;
        batch.keep_if([](std::size_t) { return true; });
    }
    bool met() const { return met_; }

private:
    const unsigned threads_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    mutable unsigned present_ = 0;
    mutable bool met_ = false, alone_ = false, first_ = true;
};

/// Tests that filters run on all threads of the pipeline. The engine's threads may be blocked inside the search.
TEST(Pipeline, FiltersOnAllItsThreadsAtOnce) {
    const auto boxes = samples::make_scene("dense", 30'000, 1);
    for (const Order order : {Order::octal, Order::ascending}) {
        Pipeline pipeline(3);
        auto filter = std::make_unique<Meeting>(3);
        const Meeting& meeting = *filter;
        pipeline.add(std::move(filter));
        Options options{.order = order, .buffer_bytes = 1 << 20};
        pipeline.run(*make_local_engine(2), all_of(boxes), {}, options);
        EXPECT_TRUE(meeting.met());
    }
}

TEST(Pipeline, FewCostlyPairsAreOnAllThreads) {
    const std::vector<Box3f> boxes(4, Box3f{{0, 0, 0}, {1, 1, 1}});
    Pipeline pipeline(3);
    auto filter = std::make_unique<Meeting>(3);
    const Meeting& meeting = *filter;
    pipeline.add(std::move(filter));
    EXPECT_EQ(pipeline.run(*make_local_engine(1), all_of(boxes), {}).collisions, 6u);
    EXPECT_TRUE(meeting.met());
}

TEST(Pipeline, PassesManyPairsAtOnceWithoutFilters) {
    const std::vector<Box3f> boxes(100, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::uint64_t calls = 0, pairs = 0;
    Pipeline(2).run(*make_local_engine(1), all_of(boxes), [&](const Batch& batch) {
        ++calls;
        pairs += batch.pairs().size();
    });
    EXPECT_EQ(pairs, 4950u);
    EXPECT_LT(calls, 100u);
}

TEST(Pipeline, HasTheLimitOfThreadsOfAnEngine) {
    EXPECT_EQ(error_of(ErrorCode::usage, [] { (void)Pipeline(max_threads + 1); }),
              "threads: 4097 is not in the range 0 to 4096");
}

}  // namespace
}  // namespace octopair::test
