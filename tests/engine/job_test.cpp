// Tests that jobs find the pairs of the direct calls, in the order of submission, and that failures give the right
// error code.
#include "engine/jobs.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <stdexcept>
#include <thread>

#include "engine/job_queue.hpp"
#include "engine/request.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

std::vector<Box3d> as_doubles(const std::vector<Box3f>& boxes) {
    std::vector<Box3d> doubles;
    for (const auto& [low, high] : boxes) doubles.push_back({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
    return doubles;
}

std::vector<double> some_padding(std::uint64_t size) {
    std::vector<double> padding(size);
    for (std::size_t i = 0; i < padding.size(); ++i) padding[i] = double(i % 7) * 1e-3;
    return padding;
}

void expect_same_summary(const Summary& found, const Summary& expected) {
    EXPECT_EQ(found.pairs, expected.pairs);
    EXPECT_EQ(found.truncated, expected.truncated);
    EXPECT_EQ(found.entries, expected.entries);
}

/// Expects that collected and streamed jobs of `objects` give the result of the direct call.
template <typename Boxes>
void expect_as_direct(const Boxes& boxes, const std::vector<double>& padding, const Options& options) {
    const auto engine = make_local_engine(2);
    PairList list;
    const Summary direct = engine->find_pairs({boxes, padding}, list, options);
    ASSERT_GT(direct.pairs, 0u);

    Job collected = engine->submit(OwnedObjects{boxes, padding}, options);
    expect_same_summary(collected.summary(), direct);
    EXPECT_TRUE(same_bytes(collected.take_pairs().to_vector(), list.to_vector()));

    std::vector<Pair> received;
    const PairSink sink = [&](std::span<const Pair> batch) {
        received.insert(received.end(), batch.begin(), batch.end());
    };
    Job streamed = engine->submit_stream(borrowed({boxes, padding}), sink, options);
    expect_same_summary(streamed.summary(), direct);
    EXPECT_TRUE(same_bytes(received, list.to_vector()));
    expect_same_summary(engine->submit_stream(borrowed({boxes, padding}), {}, options).summary(), direct);
}

TEST(Jobs, FindWhatDirectCallsFind) {
    const auto boxes = samples::make_scene("dense", scaled(50'000, 5), 1);
    const auto padding = some_padding(boxes.size());
    for (const Order order : {Order::ascending, Order::octal}) {
        SCOPED_TRACE(int(order));
        expect_as_direct(boxes, {}, {.order = order, .buffer_bytes = 0});
        expect_as_direct(boxes, padding, {.order = order, .margin = 1e-3});
        expect_as_direct(as_doubles(boxes), {}, {.order = order});
        expect_as_direct(as_doubles(boxes), padding, {.order = order, .limit = 1000});
    }
}

TEST(Jobs, JoinWhatDirectCallsJoin) {
    const auto first = samples::make_scene("dense", 5000, 1);
    const auto second = as_doubles(samples::make_scene("dense", 7000, 2));
    const auto engine = make_local_engine(2);
    for (const Order order : {Order::ascending, Order::octal}) {
        PairList list;
        const Summary direct = engine->find_pairs(Join{{first}, {second}}, list, {.order = order});
        ASSERT_GT(direct.pairs, 0u);
        Job collected = engine->submit(JobJoin{first, borrowed({second})}, {.order = order});
        expect_same_summary(collected.summary(), direct);
        EXPECT_TRUE(same_bytes(collected.take_pairs().to_vector(), list.to_vector()));

        std::vector<Pair> received;
        const PairSink sink = [&](std::span<const Pair> batch) {
            received.insert(received.end(), batch.begin(), batch.end());
        };
        expect_same_summary(engine->submit_stream(JobJoin{borrowed({first}), second}, sink, {.order = order}).summary(),
                            direct);
        EXPECT_TRUE(same_bytes(received, list.to_vector()));
    }
}

TEST(Jobs, SinkIsCalledOnTheEnginesOwnThread) {
    const auto boxes = samples::make_scene("dense", 50'000, 1);
    const auto engine = make_local_engine(2);
    std::thread::id first;
    for (int i = 0; i < 3; ++i) {
        int batches = 0;
        const PairSink sink = [&](std::span<const Pair> batch) {
            EXPECT_FALSE(batch.empty());
            if (first == std::thread::id()) first = std::this_thread::get_id();
            EXPECT_EQ(std::this_thread::get_id(), first);
            ++batches;
        };
        EXPECT_GT(engine->submit_stream(borrowed(objects_of(boxes)), sink, {.buffer_bytes = 0}).summary().pairs, 0u);
        EXPECT_GT(batches, 1);
    }
    EXPECT_NE(first, std::this_thread::get_id());
}

TEST(Jobs, RunInTheOrderOfSubmission) {
    const auto engine = make_local_engine(1);
    std::vector<int> order;
    {
        HeldJob first(*engine);
        std::vector<Job> jobs;
        for (int i = 0; i < 200; ++i) {
            jobs.push_back(engine->submit_stream(touching_boxes, [&order, i](auto) { order.push_back(i); }));
        }
        for (int i = 0; i < 200; i += 3) jobs[std::size_t(i)].cancel();
        for (const Job& job : jobs)
            EXPECT_TRUE(job.state() == JobState::queued || job.state() == JobState::cancelled) << int(job.state());
        first.let_go_on();
        for (const Job& job : jobs) job.wait();
    }
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(order.size(), 200u - 67u);
    EXPECT_TRUE(std::none_of(order.begin(), order.end(), [](int i) { return i % 3 == 0; }));
}

TEST(Jobs, ManyFromManyThreadsBesideDirectCalls) {
    const auto engine = make_local_engine(2);
    std::vector<std::jthread> callers;
    for (std::uint64_t caller = 0; caller < 6; ++caller) {
        callers.emplace_back([&, caller] {
            const auto boxes = samples::make_scene("dense", 500 + 300 * caller, caller);
            const auto expected = find_pairs(boxes);
            std::vector<Job> jobs;
            for (int i = 0; i < 20; ++i) jobs.push_back(engine->submit(boxes));
            EXPECT_TRUE(same_bytes(listed_pairs(*engine, {boxes}), expected));
            for (Job& job : jobs) EXPECT_TRUE(same_bytes(job.take_pairs().to_vector(), expected));
        });
    }
}

TEST(Jobs, ProgressRisesAndReachesBothWhoAsk) {
    const auto boxes = samples::make_scene("uniform", scaled(200'000, 10), 1);
    const auto engine = make_local_engine(2);
    double told = 0;
    Job job = engine->submit(borrowed(objects_of(boxes)), {.progress = [&](double done) {
                                 EXPECT_GE(done, told);
                                 told = done;
                             }});
    double seen = 0;
    while (!job.wait_for(std::chrono::microseconds(100))) {
        const double now = job.progress();
        EXPECT_GE(now, seen);
        EXPECT_LE(now, 1);
        seen = now;
    }
    EXPECT_EQ(job.progress(), 1);
    EXPECT_EQ(told, 1);
}

TEST(Jobs, PairsAreTakenOnce) {
    const auto engine = make_local_engine(1);
    Job job = engine->submit(touching_boxes);
    EXPECT_EQ(job.take_pairs().to_vector(), (std::vector<Pair>{{0, 1}}));
    EXPECT_EQ(code_of([&] { (void)job.take_pairs(); }), ErrorCode::usage);
    EXPECT_EQ(job.summary().pairs, 1u);
    EXPECT_EQ(job.state(), JobState::done);
    Job streamed = engine->submit_stream(touching_boxes, {});
    EXPECT_EQ(code_of([&] { (void)streamed.take_pairs(); }), ErrorCode::usage);
    EXPECT_EQ(streamed.summary().pairs, 1u);
}

TEST(Jobs, AHandleWithoutAJobIsHarmless) {
    const auto engine = make_local_engine(1);
    Job job = engine->submit(touching_boxes);
    const Job moved = std::move(job);
    Job fresh;
    for (Job* empty : {&job, &fresh}) {
        EXPECT_FALSE(empty->valid());
        EXPECT_EQ(empty->state(), JobState::cancelled);
        EXPECT_EQ(empty->progress(), 0);
        empty->cancel();
        empty->wait();
        EXPECT_TRUE(empty->wait_for(std::chrono::hours::max()));
        EXPECT_EQ(code_of([&] { (void)empty->summary(); }), ErrorCode::usage);
        EXPECT_EQ(code_of([&] { (void)empty->take_pairs(); }), ErrorCode::usage);
    }
    EXPECT_TRUE(moved.valid());
    EXPECT_EQ(moved.summary().pairs, 1u);
}

/// Expects that `job` ends with `code` and with `words` in its message, and that its engine still works.
void expect_failed(Engine& engine, Job job, ErrorCode code, const std::string& words) {
    job.wait();
    EXPECT_EQ(job.state(), code == ErrorCode::cancelled ? JobState::cancelled : JobState::failed);
    for (int i = 0; i < 2; ++i) {
        expect_error(code, words, [&] { (void)job.summary(); });
        EXPECT_EQ(code_of([&] { (void)job.take_pairs(); }), code);
    }
    EXPECT_EQ(engine.submit(touching_boxes).summary().pairs, 1u);
}

TEST(Jobs, BadBoxesFailThem) {
    const auto engine = make_local_engine(2);
    auto boxes = samples::make_scene("uniform", 1000, 1);
    boxes[777].max[1] = std::numeric_limits<float>::quiet_NaN();
    expect_failed(*engine, engine->submit(boxes), ErrorCode::bad_input, "777");
    expect_failed(*engine, engine->submit_stream(boxes, {}), ErrorCode::bad_input, "777");
    expect_failed(*engine, engine->submit(JobJoin{touching_boxes, boxes}), ErrorCode::bad_input, "777");
    expect_failed(*engine, engine->submit(OwnedObjects{touching_boxes, {0.5, -1}}), ErrorCode::bad_input, "padding");
}

TEST(Jobs, WrongOptionsAndSizesAreRefusedAtOnce) {
    const auto engine = make_local_engine(1);
    for (const bool join : {false, true}) {
        const auto with = [&](const Options& options) {
            return engine->submit({touching_boxes, join ? std::optional<JobObjects>(touching_boxes) : std::nullopt},
                                  options);
        };
        EXPECT_EQ(code_of([&] { with({.margin = -1}); }), ErrorCode::bad_input);
        EXPECT_EQ(code_of([&] { with({}); }), std::nullopt);
    }
    const std::vector<double> three = {1, 2, 3};
    const auto bad = [&] { return borrowed({touching_boxes, three}); };
    EXPECT_EQ(code_of([&] { engine->submit(bad()); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([&] { engine->submit(JobJoin{touching_boxes, bad()}); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([&] { engine->submit_stream(bad(), {}); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([&] { engine->submit_stream(JobJoin{touching_boxes, bad()}, {}); }), ErrorCode::bad_input);
    EXPECT_EQ(code_of([&] { engine->submit(OwnedObjects(touching_boxes, three)); }), ErrorCode::bad_input);
}

TEST(Jobs, WhatASinkThrowsFailsThem) {
    const auto engine = make_local_engine(2);
    const auto throwing = [&](auto what) {
        return engine->submit_stream(touching_boxes, [what](std::span<const Pair>) { throw what; });
    };
    expect_failed(*engine, throwing(Error(ErrorCode::io_failed, "my disk")), ErrorCode::io_failed, "my disk");
    expect_failed(*engine, throwing(Error(ErrorCode::cancelled, "enough")), ErrorCode::cancelled, "enough");
    expect_failed(*engine, throwing(std::runtime_error("my words")), ErrorCode::engine_failed, "my words");
    expect_failed(*engine, throwing(std::bad_alloc()), ErrorCode::resource_limit, "out of memory");
    expect_failed(*engine, throwing(42), ErrorCode::engine_failed, "exception");
}

TEST(Jobs, WhatAProgressThrowsFailsThem) {
    const auto engine = make_local_engine(2);
    const Options options = {.progress = [](double) { throw std::runtime_error("my words"); }};
    expect_failed(*engine, engine->submit(touching_boxes, options), ErrorCode::engine_failed, "my words");
}

TEST(Jobs, ASinkMayNotWaitForItsEngine) {
    const auto engine = make_local_engine(1);
    HeldJob held(*engine);
    Job queued = engine->submit(touching_boxes), sinks;
    std::optional<ErrorCode> own, next;
    sinks = engine->submit_stream(touching_boxes, [&](auto) {
        own = code_of([&] { sinks.wait(); });
        EXPECT_FALSE(sinks.wait_for(std::chrono::milliseconds(1)));
        Job later = engine->submit(touching_boxes);
        next = code_of([&] { (void)later.take_pairs(); });
        queued.wait();  // already ended, so the sink may wait
    });
    held.let_go_on();
    EXPECT_EQ(sinks.summary().pairs, 1u);
    EXPECT_EQ(own, ErrorCode::usage);
    EXPECT_EQ(next, ErrorCode::usage);
}

/// An engine that fails in a selected way.
class FailingEngine final : public Engine {
public:
    explicit FailingEngine(std::exception_ptr what) : what_(what) {}

private:
    Summary run(const detail::Request&, const detail::Output&, const detail::Control&) override {
        std::rethrow_exception(what_);
    }
    detail::JobQueue& jobs() override { return jobs_; }
    std::shared_ptr<void> allocate(std::size_t) override { std::rethrow_exception(what_); }

    std::exception_ptr what_;
    detail::JobQueue jobs_{*this};
};

TEST(Jobs, WhatAnEngineThrowsFailsThem) {
    FailingEngine dead(std::make_exception_ptr(Error(ErrorCode::engine_failed, "a worker died")));
    EXPECT_EQ(code_of([&] { (void)dead.submit(touching_boxes).summary(); }), ErrorCode::engine_failed);
    FailingEngine full(std::make_exception_ptr(std::bad_alloc()));
    EXPECT_EQ(code_of([&] { (void)full.submit(touching_boxes).summary(); }), ErrorCode::resource_limit);
    EXPECT_EQ(code_of([&] { (void)full.allocate_boxes(7); }), ErrorCode::resource_limit);
}

template <typename Element>
class AllocatedBoxes : public ::testing::Test {};
using Elements = ::testing::Types<Box3f, Box3d>;
TYPED_TEST_SUITE(AllocatedBoxes, Elements);

TYPED_TEST(AllocatedBoxes, AreObjectsLikeAnyOthers) {
    auto engine = make_local_engine(2);
    for (const std::uint64_t size : {2u, 3000u, 200'000u}) {
        const auto scene = samples::make_scene("dense", size, 1);
        BoxArray<TypeParam> array = engine->template allocate_boxes<TypeParam>(size);
        ASSERT_EQ(array.size(), size);
        ASSERT_EQ(array.boxes().size(), size);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.boxes().data()) % 64, 0u);
        for (std::size_t i = 0; i < scene.size(); ++i) {
            std::copy_n(scene[i].min, 3, array.boxes()[i].min);
            std::copy_n(scene[i].max, 3, array.boxes()[i].max);
        }
        const std::vector<Pair> list = listed_pairs(*engine, {array.boxes()});
        const auto expected = find_pairs(scene);
        EXPECT_TRUE(same_bytes(list, expected));
        EXPECT_TRUE(same_bytes(engine->submit(std::move(array)).take_pairs().to_vector(), expected));
        EXPECT_EQ(array.size(), 0u);
    }
}

TYPED_TEST(AllocatedBoxes, OutliveTheirEngineAndMove) {
    BoxArray<TypeParam> kept;
    EXPECT_EQ(kept.size(), 0u);
    kept = make_local_engine(1)->template allocate_boxes<TypeParam>(100);
    for (TypeParam& box : kept.boxes()) box = {{0, 0, 0}, {1, 1, 1}};
    BoxArray<TypeParam> moved = std::move(kept);
    EXPECT_TRUE(kept.boxes().empty());
    kept = std::move(moved);
    EXPECT_EQ(moved.size(), 0u);
    EXPECT_EQ(make_local_engine(1)->count_pairs({kept.boxes()}), 4950u);
}

TYPED_TEST(AllocatedBoxes, MoreThanThereCanBeAreRefused) {
    const auto engine = make_local_engine(1);
    const std::uint64_t whole = std::numeric_limits<std::size_t>::max() / sizeof(TypeParam);
    for (const std::uint64_t count : {std::uint64_t(1) << 32, whole, whole + 1, whole + 3, ~std::uint64_t(0)}) {
        EXPECT_EQ(code_of([&] { (void)engine->template allocate_boxes<TypeParam>(count); }), ErrorCode::resource_limit);
    }
    EXPECT_EQ(engine->template allocate_boxes<TypeParam>(0).size(), 0u);
}

}  // namespace
}  // namespace octopair::test
