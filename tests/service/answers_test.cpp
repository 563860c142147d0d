// Tests that a server gives the same bytes as local threads, for every kind of scene and every kind of call.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "octopair/processes.hpp"
#include "processes/asked.hpp"
#include "samples/scenes.hpp"
#include "service/served.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/families.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

void use_processes(service::ServerOptions& options) {
    options.engine_name = "processes";
    options.engine = [](unsigned width) { return make_process_engine(width); };
}

struct Found {
    std::uint64_t pairs = 0, hash = 0;
    bool operator==(const Found&) const = default;
};

Found listed(Engine& engine, std::span<const Box3f> boxes, Order order) {
    PairList list;
    (void)engine.find_pairs({boxes, {}}, list, {.order = order});
    Hash hash;
    for (const auto chunk : list.chunks()) hash.add(chunk);
    return {list.size(), hash.value()};
}

Found streamed(Engine& engine, std::span<const Box3f> boxes, Order order) {
    Hash hash;
    const PairSink sink = [&](std::span<const Pair> batch) { hash.add(batch); };
    return {engine.stream_pairs({boxes, {}}, sink, {.order = order}).pairs, hash.value()};
}

/// Tests a scene whose nested octrees once reported pairs twice. With `verify`, the client checks the received pairs.
TEST(ServedExactness, GivesEachPairOnce) {
    const std::vector<Box3f> boxes = long_tailed_boxes(scaled(40'000, 4), 2);
    const Served served;
    const auto engine = served.client();
    for (const Order order : {Order::ascending, Order::octal}) {
        PairList list;
        const Summary summary = engine->find_pairs({boxes, {}}, list, {.order = order, .verify = true});
        EXPECT_TRUE(summary.verification.done);
        EXPECT_EQ(list.size(), engine->count_pairs({boxes, {}}, {.verify = true}));
    }
}

class ServedHashes : public ::testing::TestWithParam<std::string> {};

TEST_P(ServedHashes, AreThoseOfThreads) {
    const Pinned& pinned = pinned_scene(GetParam());
    if (sanitized && pinned.pairs > 1'000'000) GTEST_SKIP() << "a call takes a second under sanitizers";
    const std::vector<Box3f> boxes = samples::make_scene(GetParam(), pinned.objects, 1);
    const Found ascending{pinned.pairs, pinned.pair_hash};
    const Found octal = listed(*make_local_engine(2), boxes, Order::octal);
    for (const Served::Change& change : {Served::Change(), Served::Change(use_processes)}) {
        const Served served(change);
        const auto engine = served.client();
        EXPECT_EQ(listed(*engine, boxes, Order::ascending), ascending);
        EXPECT_EQ(streamed(*engine, boxes, Order::ascending), ascending);
        EXPECT_EQ(listed(*engine, boxes, Order::octal), octal);
        EXPECT_EQ(streamed(*engine, boxes, Order::octal), octal);
        EXPECT_EQ(engine->count_pairs({boxes}), pinned.pairs);
        EXPECT_TRUE(served.comes_to_rest());
    }
}

INSTANTIATE_TEST_SUITE_P(, ServedHashes, ::testing::ValuesIn(sample_kind_names()), param_name);

/// Returns the answer to a call with the objects of a case. The count and the truncation come from the call's summary.
Answer answer_of(Engine& engine, const Case& a_case, const Asked& asked) {
    Options options{
        .order = asked.order, .margin = a_case.margin, .limit = asked.limit, .buffer_bytes = a_case.buffer_bytes};
    const Input input = a_case.input();
    Answer answer;
    Summary summary;
    if (asked.how == How::list) {
        PairList list;
        summary = engine.find_pairs(input, list, options);
        answer.pairs = list.to_vector();
    } else {
        const PairSink keep = [&](auto batch) { answer.pairs.insert(answer.pairs.end(), batch.begin(), batch.end()); };
        const PairSink sink = asked.how == How::stream ? keep : PairSink();
        summary = engine.stream_pairs(input, sink, options);
    }
    answer.count = summary.pairs;
    answer.truncated = summary.truncated;
    return answer;
}

TEST(ServedProperty, AgreesWithThreads) {
    const Served threads, processes(use_processes);
    const auto local = make_local_engine(2), one = threads.client(), other = processes.client();
    const auto kinds = all_kind_names();
    const bool held = rc::check("a server finds what threads find", [&] {
        const auto kind = *rc::gen::elementOf(kinds);
        const auto seed = *rc::gen::arbitrary<std::uint32_t>();
        for (std::uint64_t i = 0; i < scaled(3, 3); ++i) {
            const Case a_case = make_case(kind, seed + i);
            RC_LOG() << kind << ", seed " << seed + i << ": " << a_case.describe() << "\n";
            for (Asked asked : all_ways()) {
                if (asked.windows) asked.limit = a_case.limit;
                const Answer expected = answer_of(*local, a_case, asked);
                RC_ASSERT(answer_of(*one, a_case, asked) == expected);
                RC_ASSERT(answer_of(*other, a_case, asked) == expected);
            }
        }
    });
    EXPECT_TRUE(held);
}

TEST(ServedJobs, AreThoseOfThreads) {
    const Served served;
    const auto local = make_local_engine(2), remote = served.client();
    const Scene scene("clustered", 3000, 1);
    const Objects first = scene.objects({}), second = scene.others({});
    PairList expected, expected_between;
    (void)local->find_pairs(first, expected);
    (void)local->find_pairs(Join{first, second}, expected_between);
    std::vector<Pair> streamed;
    const PairSink sink = [&](auto batch) { streamed.insert(streamed.end(), batch.begin(), batch.end()); };
    Job listed = remote->submit(scene.first);
    Job between = remote->submit(JobJoin{borrowed(first), scene.second});
    Job stream = remote->submit_stream(borrowed(first), sink);
    EXPECT_EQ(listed.take_pairs().to_vector(), expected.to_vector());
    EXPECT_EQ(between.take_pairs().to_vector(), expected_between.to_vector());
    EXPECT_EQ(stream.summary().pairs, expected.size());
    EXPECT_EQ(streamed, expected.to_vector());
    EXPECT_EQ(listed.progress(), 1);
}

TEST(ServedProgress, NeverFallsAndEndsAtOne) {
    const Served served;
    const Scene scene("clustered", scaled(200'000, 4), 1);
    std::vector<double> told;
    Options options;
    options.progress = [&](double done) { told.push_back(done); };
    (void)served.client()->count_pairs(scene.objects({}), options);
    ASSERT_FALSE(told.empty());
    EXPECT_EQ(told.back(), 1);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
}

}  // namespace
}  // namespace octopair::test
