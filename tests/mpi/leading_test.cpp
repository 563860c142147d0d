// Tests the engine of rank 0 that other ranks follow. Its caller uses the common Engine interface.
#include "engine/mpi/leading/leading.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "engine/mpi/comm/heartbeat.hpp"
#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Makes calls of an engine on rank 0. Other ranks follow that engine.
template <typename Calls>
void lead(const Calls& calls, unsigned threads = 1) {
    if (own_rank() != 0) return follow(MPI_COMM_WORLD, {.threads = threads});
    const auto engine = make_leading_engine(MPI_COMM_WORLD, {.threads = threads});
    calls(*engine);
}

class RankLeadingProperty : public ::testing::TestWithParam<std::string> {};

/// Makes all calls on one engine, which reuses the objects that it distributed before.
TEST_P(RankLeadingProperty, AgreesWithThreads) {
    lead([&](Engine& engine) {
        const auto local = make_local_engine(1);
        for (std::uint64_t i = 0; i < case_count(scaled(2, 1)); ++i) {
            const std::uint64_t seed = case_seed(GetParam(), i);
            const Case whole = make_case(GetParam(), seed);
            SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ": " + whole.describe());
            for (unsigned way = 0; way < 8; ++way) {
                const AnyCall call{whole, (way & 1) != 0 ? Order::octal : Order::ascending, (way & 2) != 0,
                                   (way & 4) != 0};
                EXPECT_TRUE(same_bytes(call.made_by(engine), call.made_by(*local)));
                EXPECT_EQ(call.counted_by(engine), call.counted_by(*local));
            }
            if (HasFailure()) break;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(, RankLeadingProperty, ::testing::ValuesIn(all_kind_names()), param_name);

class RankLeading : public ::testing::Test {
protected:
    Objects objects() const { return {boxes_, {}}; }
    void expect_usable(Engine& engine) const {
        PairList list;
        const Summary summary = engine.find_pairs(objects(), list);
        EXPECT_TRUE(same_bytes(list.to_vector(), expected_));
        EXPECT_EQ(summary.pairs, expected_.size());
        EXPECT_FALSE(summary.truncated);
        EXPECT_GT(summary.entries, 0u);
    }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 5'000, 1);
    const std::vector<Pair> expected_ = find_pairs(boxes_);
    /// Boxes whose detection takes seconds.
    const std::vector<Box3f> many_{60'000, Box3f{{0, 0, 0}, {1, 1, 1}}};
};

/// Streams far more pairs than the buffer holds. In octal order, some ranks find their pairs a second time. In
/// ascending order, pairs are sent in windows.
TEST_F(RankLeading, StreamsInBoundedMemory) {
    // The coincident boxes are at one place, which a single rank owns. All ranks own some boxes of the loop.
    std::vector<Box3f> boxes = samples::make_scene("coincident", scaled(1'000, 1), 1);
    for (std::size_t i = 0; i < scaled(6'000, 2); ++i) {
        Box3f& box = boxes.emplace_back();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = float((i * (axis * 24 + 7)) % 1009) / 1009;
            box.max[axis] = box.min[axis] + 0.15F;
        }
    }
    const Objects all{boxes, {}};
    lead([&](Engine& engine) {
        const auto local = make_local_engine(1);
        const std::uint64_t count = local->count_pairs(all);
        ASSERT_GT(count, scaled(10 << 17, 4));  // 2^17 pairs are 1 MiB
        std::vector<std::optional<std::uint64_t>> limits = {{}, count / 3};
        if (!sanitized) limits.insert(limits.end(), {7, count - 5, count});
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const auto& limit : limits) {
                Options options{.order = order, .limit = limit, .buffer_bytes = 1 << 20};
                const auto streamed = [&](Engine& from) {
                    std::vector<Pair> pairs;
                    const Summary summary = from.stream_pairs(
                        all, [&](auto some) { pairs.insert(pairs.end(), some.begin(), some.end()); }, options);
                    EXPECT_EQ(summary.pairs, pairs.size());
                    EXPECT_EQ(summary.truncated, limit && *limit < count);
                    return pairs;
                };
                EXPECT_TRUE(same_bytes(streamed(engine), streamed(*local)));
            }
        }
    });
}

TEST_F(RankLeading, HasThreadsInEachRank) {
    lead([&](Engine& engine) { expect_usable(engine); }, 2);
}

TEST_F(RankLeading, ReportsErrorsLikeTheLocalEngine) {
    lead([&](Engine& engine) {
        const auto local = make_local_engine(1);
        const auto expect_same = [&](ErrorCode code, const auto& call) {
            EXPECT_EQ(error_of(code, [&] { call(engine); }), error_of(code, [&] { call(*local); }));
            expect_usable(engine);
        };
        std::vector<Box3f> bad = boxes_;
        bad[4'990].min[0] = bad[4'990].max[0] + 1;
        bad[4'000].max[2] = std::numeric_limits<float>::quiet_NaN();
        const Objects bad_boxes{bad, {}};
        expect_same(ErrorCode::bad_input, [&](Engine& any) { (void)any.count_pairs(bad_boxes); });
        expect_same(ErrorCode::bad_input, [&](Engine& any) { (void)any.count_pairs(Join{objects(), bad_boxes}); });
        std::vector<double> padding(boxes_.size(), 0.1);
        padding[4'500] = -1;
        const Objects bad_padding{boxes_, padding};
        expect_same(ErrorCode::bad_input, [&](Engine& any) { (void)any.count_pairs(bad_padding); });
        const Objects few_paddings{boxes_, std::span(padding).first(3)};
        expect_same(ErrorCode::bad_input, [&](Engine& any) { (void)any.count_pairs(few_paddings); });
        Options options{.margin = -1};
        expect_same(ErrorCode::bad_input, [&](Engine& any) { (void)any.count_pairs(objects(), options); });
    });
}

struct Full : std::runtime_error {
    using std::runtime_error::runtime_error;
};
struct Refused : Error {
    using Error::Error;
};

TEST_F(RankLeading, PassesOnWhatTheCallersFunctionsThrow) {
    lead([&](Engine& engine) {
        for (const Order order : {Order::octal, Order::ascending}) {
            Options options{.order = order};
            std::size_t taken = 0;
            const auto full_after = [&](std::size_t most) {
                return [&taken, most](std::span<const Pair> some) {
                    taken += some.size();
                    if (taken > most) throw Full("full");
                };
            };
            EXPECT_THROW((void)engine.stream_pairs(objects(), full_after(0), options), Full);
            taken = 0;  // the sink throws at the last pairs, which another rank found
            EXPECT_THROW((void)engine.stream_pairs(objects(), full_after(expected_.size() - 1), options), Full);
            EXPECT_THROW(
                (void)engine.stream_pairs(
                    objects(), [](std::span<const Pair>) { throw Refused(ErrorCode::resource_limit, "no more"); },
                    options),
                Refused);
            options.progress = [](double) { throw Full("seen enough"); };
            EXPECT_THROW((void)engine.count_pairs(objects(), options), Full);
            expect_usable(engine);
        }
    });
}

TEST_F(RankLeading, EndsAllRanksAtAStop) {
    lead([&](Engine& engine) {
        (void)error_of(ErrorCode::cancelled, [&] { (void)engine.count_pairs(objects(), {}, requested_stop()); });
        for (const Order order : {Order::octal, Order::ascending}) {
            std::stop_source stop;
            const std::jthread stopper([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                stop.request_stop();
            });
            Options options{.order = order};
            const PairSink sink = [](std::span<const Pair>) {};
            (void)error_of(ErrorCode::cancelled, [&] {
                (void)engine.stream_pairs({many_, {}}, sink, options, stop.get_token());
            });
        }
        expect_usable(engine);
    });
}

TEST_F(RankLeading, HasJobsAndCallsFromAllThreads) {
    lead([&](Engine& engine) {
        double last = 0;
        Options options;
        options.progress = [&](double done) {
            EXPECT_GE(done, last);
            last = done;
        };
        Job job = engine.submit(borrowed(objects()), options);
        Job cancelled = engine.submit(borrowed(Objects{many_}));
        std::vector<std::jthread> callers;
        callers.reserve(3);
        for (int i = 0; i < 3; ++i) callers.emplace_back([&] { expect_usable(engine); });
        EXPECT_TRUE(same_bytes(job.take_pairs().to_vector(), expected_));
        EXPECT_EQ(last, 1);
        cancelled.cancel();
        EXPECT_THROW((void)cancelled.take_pairs(), Error);
    });
}

TEST_F(RankLeading, IsFollowedAgainAndByNobodyElse) {
    for (int i = 0; i < 3; ++i) lead([&](Engine& engine) { expect_usable(engine); });
}

TEST(RankHeartbeat, NamesTheSilentRank) {
    if (rank_count() == 1) GTEST_SKIP() << "no other rank";
    const bool first = own_rank() == 0, last = own_rank() + 1 == rank_count();
    constexpr std::chrono::milliseconds silence(2000);  // longer than the stalls of a busy machine
    Communicator comm(MPI_COMM_WORLD);
    Heartbeat heartbeat(comm, silence);
    const auto work = [&](int times, const auto& each) {
        for (int i = 0; i < times; ++i) {
            each();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    };
    heartbeat.begin();
    work(500, [&] { EXPECT_NO_THROW(heartbeat.beat()); });  // longer than `silence`
    MPI_Barrier(MPI_COMM_WORLD);
    if (first) {
        heartbeat.begin();
        const auto begun = std::chrono::steady_clock::now();
        EXPECT_THROW(work(1000, [&] { heartbeat.beat(); }), Error);
        EXPECT_GE(std::chrono::steady_clock::now() - begun, silence);
        ASSERT_TRUE(heartbeat.lost());
        EXPECT_EQ(*heartbeat.lost(), "rank " + std::to_string(rank_count() - 1) + " has not answered for 2 s");
    } else if (!last) {
        work(500, [&] { heartbeat.beat(); });
    }
    heartbeat.end();
}

}  // namespace
}  // namespace octopair::test
