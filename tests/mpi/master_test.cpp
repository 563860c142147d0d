// Tests the paper's master-worker arrangement on ranks: the master finds the pairs that threads find, and other ranks
// take part.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>
#include <stdexcept>
#include <thread>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "octree/cell_sweep/cell_entry.hpp"
#include "samples/scenes.hpp"
#include "support/any_call.hpp"
#include "support/compare.hpp"
#include "support/hash.hpp"
#include "support/kinds.hpp"
#include "support/pinned.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using test::AnyCall;
using test::Case;
using test::own_rank;
using test::rank_count;
using test::Spread;

std::unique_ptr<Engine> make_paper_engine(unsigned ranks_per_machine = 2, unsigned threads = 1) {
    return make_mpi_engine(
        MPI_COMM_WORLD,
        {.threads = threads, .arrangement = Arrangement::paper, .ranks_per_machine = ranks_per_machine});
}

Objects view(const std::vector<Box3f>& boxes) { return {std::span<const Box3f>(boxes), {}}; }

/// Expects that the master has all pairs and other ranks have none. Only the master computes the expected pairs. All
/// ranks continue after a failure.
void expect_at_master(const std::vector<Pair>& own, const std::function<std::vector<Pair>()>& expected) {
    if (own_rank() == 0) {
        EXPECT_TRUE(test::same_bytes(own, expected()));
    } else {
        EXPECT_TRUE(own.empty());
    }
}

std::vector<Pair> listed(Engine& engine, const Objects& objects, Order order) {
    PairList list;
    Options options;
    options.order = order;
    (void)engine.find_pairs(objects, list, options);
    return list.to_vector();
}

TEST(RankMaster, HasTheHashesOfThreads) {
    const auto local = make_local_engine(1);
    unsigned number = 0;
    for (const std::string_view kind : samples::scene_kinds()) {
        const test::Pinned& pinned = test::pinned_scene(kind);
        const Spread spread = test::spreads[number % 3];
        SCOPED_TRACE(std::string(kind) + ", " + test::name_of(spread));
        const auto engine = make_paper_engine(1 + number % 3, 1 + number % 2);
        ++number;
        const std::vector<Box3f> boxes = samples::make_scene(std::string(kind), pinned.objects, 1);
        const std::vector<Box3f> own = test::slice(boxes, spread);
        EXPECT_EQ(engine->count_pairs(view(own)), pinned.pairs);
        if (pinned.pairs > 300'000) continue;
        const std::vector<Pair> ascending = listed(*engine, view(own), Order::ascending);
        EXPECT_EQ(test::hash_of(ascending), own_rank() == 0 ? pinned.pair_hash : test::hash_of(std::vector<Pair>()));
        expect_at_master(listed(*engine, view(own), Order::octal),
                         [&] { return listed(*local, view(boxes), Order::octal); });
    }
}

/// Tests joins, paddings, margins, precisions, limits and streams.
TEST(RankMaster, AgreesWithThreadsOnAnyCall) {
    const auto local = make_local_engine(1);
    const auto engine = make_paper_engine();
    unsigned number = 0;
    for (const std::string& kind : test::all_kind_names()) {
        for (std::uint64_t i = 0; i < test::case_count(test::scaled(2, 2)); ++i) {
            const std::uint64_t seed = test::case_seed(kind, i);
            const Case whole = test::make_case(kind, seed);
            SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ": " + whole.describe());
            const Case own = test::slice(whole, test::spreads[number++ % 3]);
            for (const Order order : {Order::octal, Order::ascending}) {
                for (const bool limited : {false, true}) {
                    const bool streamed = (number + unsigned(order) + unsigned(limited)) % 2 == 0;
                    const AnyCall expected{whole, order, streamed, limited}, asked{own, order, streamed, limited};
                    expect_at_master(asked.made_by(*engine), [&] { return expected.made_by(*local); });
                    EXPECT_EQ(asked.counted_by(*engine), expected.counted_by(*local));
                }
            }
        }
    }
}

TEST(RankMaster, StreamsInWindowsUpToALimit) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 100'000, 1);
    const std::vector<Box3f> own = test::slice(boxes, Spread::even);
    const std::vector<Pair> expected = find_pairs(boxes);
    const auto engine = make_paper_engine();
    Options options;
    options.buffer_bytes = 1 << 20;
    ASSERT_GT(expected.size() * sizeof(Pair), 2 * options.buffer_bytes);
    for (const std::uint64_t limit : {std::uint64_t(expected.size()), std::uint64_t(expected.size() / 2)}) {
        options.limit = limit;
        std::vector<Pair> found;
        const Summary summary = engine->stream_pairs(
            view(own), [&](std::span<const Pair> batch) { found.insert(found.end(), batch.begin(), batch.end()); },
            options);
        EXPECT_EQ(summary.pairs, limit);
        EXPECT_EQ(summary.truncated, limit < expected.size());
        const auto wanted = std::span(expected).first(limit);
        expect_at_master(found, [&] { return std::vector<Pair>(wanted.begin(), wanted.end()); });
    }
}

TEST(RankMaster, GathersWhatIsThereAlready) {
    const std::vector<Box3f> boxes = samples::make_scene("uniform", 20'000, 1);
    const auto engine = make_paper_engine();
    PairList pairs;
    const Summary summary = engine->find_pairs(view(test::slice(boxes, Spread::lopsided)), pairs);
    EXPECT_EQ(summary.pairs, find_pairs(boxes).size());
    gather_pairs(*engine, pairs);
    expect_at_master(pairs.to_vector(), [&] { return find_pairs(boxes); });
}

TEST(RankMaster, IsOneOfTheRanksThatBuildLists) {
    constexpr std::uint64_t objects = 50'000;
    const std::vector<Box3f> boxes = samples::make_scene("uniform", objects, 1);
    const auto engine = make_paper_engine();
    const std::uint64_t ranks = rank_count(), rank = own_rank();
    const bool master = rank == 0, merges = rank % 2 == 0 && rank + 1 < ranks;
    const std::uint64_t run = objects * (rank + 1) / ranks - objects * rank / ranks;
    EXPECT_EQ(engine->count_pairs(view(master ? boxes : std::vector<Box3f>())), find_pairs(boxes).size());
    const RankCosts costs = last_costs(*engine);
    EXPECT_EQ(costs.objects, master ? objects : 0);
    EXPECT_EQ(costs.objects_received, master ? 0 : run);
    EXPECT_GT(costs.build, 0);
    EXPECT_EQ(costs.scan > 0, master);
    if (master) {  // the master sends boxes, but no entries
        EXPECT_GE(costs.bytes_sent, (objects - run) * sizeof(Box3f));
        EXPECT_LT(costs.bytes_sent, objects * sizeof(Box3f) * 5 / 4);
    } else {
        EXPECT_GE(costs.bytes_sent, run * sizeof(CellEntry));
    }
    if (master || merges) {
        EXPECT_GT(costs.merge, 0.00001);
    } else {
        EXPECT_LT(costs.merge, costs.build / 10);
    }
}

/// The rank with the bad box in its run finds that box, and all ranks report the local engine's message.
TEST(RankMaster, NamesTheFirstBadBox) {
    std::vector<Box3f> boxes = samples::make_scene("dense", 5'000, 1);
    const std::vector<Box3f> good = boxes;
    const auto engine = make_paper_engine();
    for (const std::size_t bad : {std::size_t(4'987), std::size_t(2'500), std::size_t(12)}) {
        boxes[bad].max[1] = std::numeric_limits<float>::quiet_NaN();  // keeps the bad boxes of the rounds before
        const std::vector<Box3f> own = test::slice(boxes, Spread::lopsided);
        const std::vector<Box3f> well = test::slice(good, Spread::even);
        PairList list;
        EXPECT_EQ(test::message_of(ErrorCode::bad_input, [&] { (void)engine->find_pairs(view(own), list); }),
                  test::message_of(ErrorCode::bad_input, [&] { (void)find_pairs(boxes); }));
        EXPECT_EQ(test::message_of(ErrorCode::bad_input,
                                   [&] {
                                       (void)engine->count_pairs(Join{view(well), view(own)});
                                   }),
                  test::message_of(ErrorCode::bad_input, [&] {
                      (void)make_local_engine(1)->count_pairs(Join{view(good), view(boxes)});
                  }));
    }
    EXPECT_EQ(engine->count_pairs(view(test::slice(good, Spread::even))), find_pairs(good).size());
}

TEST(RankMaster, EndsOnAllWhereItsReceiverFails) {
    const std::vector<Box3f> boxes = samples::make_scene("dense", 5'000, 1);
    const std::vector<Box3f> own = test::slice(boxes, Spread::even);
    const auto engine = make_paper_engine();
    const auto call = [&] {
        (void)engine->stream_pairs(view(own), [](std::span<const Pair>) { throw std::runtime_error("full"); });
    };
    if (own_rank() == 0) {
        EXPECT_THROW(call(), std::runtime_error);
    } else {
        EXPECT_EQ(test::message_of(ErrorCode::engine_failed, call), "rank 0: the receiver of the pairs failed");
    }
    expect_at_master(listed(*engine, view(own), Order::ascending), [&] { return find_pairs(boxes); });
}

/// Stops a master's scan that would take many seconds while the other ranks wait.
TEST(RankMaster, IsStoppedByAnotherRank) {
    const auto engine = make_paper_engine();
    const std::vector<Box3f> many(60'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    for (const Order order : {Order::octal, Order::ascending}) {
        std::stop_source stop;
        std::jthread stopper;
        if (own_rank() + 1 == rank_count()) {
            stopper = std::jthread([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                stop.request_stop();
            });
        }
        Options options;
        options.order = order;
        PairList list;
        EXPECT_EQ(test::message_of(ErrorCode::cancelled,
                                   [&] { (void)engine->find_pairs(view(many), list, options, stop.get_token()); }),
                  "cancelled");
    }
}

TEST(RankMaster, HasFewObjectsOrNone) {
    const auto engine = make_paper_engine();
    const Box3f box{{0, 0, 0}, {1, 1, 1}};
    const std::vector<Box3f> one_each(1, box), none;
    const std::uint64_t ranks = rank_count();
    EXPECT_EQ(engine->count_pairs(view(none)), 0u);
    const std::size_t found = listed(*engine, view(one_each), Order::octal).size();
    EXPECT_EQ(found, own_rank() == 0 ? ranks * (ranks - 1) / 2 : 0);
    EXPECT_EQ(engine->count_pairs(Join{view(one_each), {std::span<const Box3d>(), {}}}), 0u);
}

TEST(RankMaster, NeedsTheSameArrangementOnAllRanks) {
    EXPECT_EQ(test::message_of(ErrorCode::usage, [] { (void)make_paper_engine(0); }),
              "ranks_per_machine is 0; it must be at least 1");
    if (rank_count() == 1) GTEST_SKIP() << "one rank cannot differ";
    EXPECT_EQ(test::message_of(ErrorCode::usage, [] { (void)make_paper_engine(own_rank() == 0 ? 1 : 2); }),
              "the ranks' engines differ in arrangement or ranks_per_machine");
    EXPECT_EQ(test::message_of(ErrorCode::usage,
                               [] { (void)(own_rank() == 0 ? make_paper_engine() : make_mpi_engine(MPI_COMM_WORLD)); }),
              "the ranks' engines differ in arrangement or ranks_per_machine");
}

}  // namespace
}  // namespace octopair::test
