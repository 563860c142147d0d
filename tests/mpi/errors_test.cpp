// Tests that an error on one rank ends the call on all ranks with the same Error, and that the engine stays usable.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/reentry.hpp"

namespace octopair::test {
namespace {

class RankErrors : public ::testing::Test {
protected:
    Objects own() const { return {own_, {}}; }
    /// Returns the Error that a call throws on this rank, or nothing.
    template <typename Call>
    static std::optional<Error> error_of(const Call& call) {
        try {
            call();
        } catch (const Error& error) {
            return error;
        }
        return std::nullopt;
    }
    template <typename Call>
    void expect_on_all(ErrorCode code, const std::string& message, const Call& call) {
        const auto error = error_of(call);
        ASSERT_TRUE(on_all(error.has_value()));
        EXPECT_EQ(int(error->code()), int(code)) << error->what();
        EXPECT_TRUE(has_text(error->what(), message));
        expect_usable();
    }
    void expect_usable() { EXPECT_TRUE(same_bytes(all_pieces(listed_pairs(*engine_, own())), expected_)); }
    bool last() const { return own_rank() + 1 == rank_count(); }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 5'000, 1);
    const std::vector<Pair> expected_ = find_pairs(boxes_);
    std::vector<Box3f> own_ = slice(boxes_, Spread::even);
    const std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankErrors, NameTheFirstBadBoxOfAllRanks) {
    const std::size_t begin = own_slice(boxes_.size(), Spread::even).begin;
    std::vector<Box3f> bad = own_;
    // Two bad boxes on each rank. The first of all is on rank 0.
    bad[17].max[1] = std::numeric_limits<float>::quiet_NaN();
    bad[12].min[0] = bad[12].max[0] + 1;
    PairList list;
    expect_on_all(ErrorCode::bad_input, "object 12: min x", [&] { (void)engine_->find_pairs({bad, {}}, list); });
    EXPECT_EQ(list.size(), 0u);
    // Bad boxes on the last rank only: the message has the global index.
    const std::vector<Box3f>& some = last() ? bad : own_;
    const std::size_t of_last = std::size_t(largest(last() ? begin + 12 : 0));
    expect_on_all(ErrorCode::bad_input, "object " + std::to_string(of_last) + ": min x", [&] {
        (void)engine_->count_pairs({some, {}});
    });
    expect_on_all(ErrorCode::bad_input, "second set: object " + std::to_string(of_last) + ": min x", [&] {
        (void)engine_->count_pairs(Join{own(), {some, {}}});
    });
    expect_place([&] { (void)engine_->count_pairs({some, {}}); }, of_last, 0);
    expect_place([&] { (void)engine_->count_pairs(Join{own(), {some, {}}}); }, of_last, 1);
}

TEST_F(RankErrors, RefuseCallsInTheirSinks) {
    bool tried = false;
    (void)engine_->stream_pairs(own(), [&](std::span<const Pair>) {
        if (!std::exchange(tried, true)) expect_calls_refused(*engine_);
    });
    EXPECT_GT(largest(tried ? 1 : 0), 0u);
    EXPECT_EQ(engine_->count_pairs(own()), engine_->count_pairs(own()));
}

/// With several threads, a progress function runs on other threads than that of the call, too.
TEST_F(RankErrors, RefuseCallsInTheirProgressFunctions) {
    const auto engine = make_mpi_engine(MPI_COMM_WORLD, {.threads = 4});
    const std::vector<Box3f> boxes = slice(samples::make_scene("dense", 40'000, 1), Spread::even);
    const Objects input{boxes};
    std::atomic<int> reports = 0;
    const auto try_all = [&](double) {
        ++reports;
        expect_calls_refused(*engine);
        std::vector<Pair64> wide;
        PairList gathered;
        expect_deadlock_refused([&] { (void)find_pairs64(*engine, IndexedObjects{input, {}}, wide); });
        expect_deadlock_refused([&] { gather_pairs(*engine, gathered); });
    };
    const std::vector<Pair> pairs = listed_pairs(*engine, input, {.progress = try_all});
    EXPECT_GT(reports.exchange(0), 0);
    std::vector<Pair64> found;
    (void)find_pairs64(*engine, IndexedObjects{input, {}}, found, {.progress = try_all});
    EXPECT_GT(reports, 0);
    EXPECT_EQ(all_pieces(found).size(), all_pieces(pairs).size());
}

TEST_F(RankErrors, RefuseToVerify) {
    Options verifying;
    verifying.verify = last();  // on a single rank
    PairList list;
    expect_on_all(ErrorCode::usage, "verify: the MPI engine cannot",
                  [&] { (void)engine_->find_pairs(own(), list, verifying); });
}

TEST_F(RankErrors, TellOfPaddingsThatOneRankGaveWrongly) {
    const std::vector<double> padding(last() ? 3 : own_.size(), 0.1);
    expect_on_all(ErrorCode::bad_input, "3 paddings", [&] { (void)engine_->count_pairs({own_, padding}); });
}

TEST_F(RankErrors, RefuseCallsThatDiffer) {
    if (rank_count() == 1) GTEST_SKIP() << "one rank cannot differ";
    Options options;
    if (last()) options.margin = 0.5;
    expect_on_all(ErrorCode::usage, "the margin", [&] { (void)engine_->count_pairs(own(), options); });
    options = {};
    if (last()) options.order = Order::octal;
    expect_on_all(ErrorCode::usage, "the order", [&] { (void)engine_->count_pairs(own(), options); });
    options = {};
    if (last()) options.limit = 7;
    expect_on_all(ErrorCode::usage, "the limit", [&] { (void)engine_->count_pairs(own(), options); });
    options = {};
    if (last()) options.buffer_bytes = 1 << 20;
    expect_on_all(ErrorCode::usage, "the size of the buffer", [&] { (void)engine_->count_pairs(own(), options); });
    expect_on_all(ErrorCode::usage, "the number of sets", [&] {
        last() ? (void)engine_->count_pairs(own()) : (void)engine_->count_pairs(Join{own(), own()});
    });
    expect_on_all(ErrorCode::usage, "count, list, stream", [&] {
        PairList list;
        last() ? (void)engine_->count_pairs(own()) : (void)engine_->find_pairs(own(), list);
    });
    expect_on_all(ErrorCode::usage, "64-bit indices", [&] {
        PairList list;
        std::vector<Pair64> pairs;
        last() ? (void)engine_->find_pairs(own(), list)
               : (void)find_pairs64(*engine_, IndexedObjects{own(), {}}, pairs);
    });
    expect_on_all(ErrorCode::usage, "gather_pairs or a search", [&] {
        PairList list;
        last() ? (void)engine_->find_pairs(own(), list) : gather_pairs(*engine_, list);
    });
    expect_on_all(ErrorCode::usage, "gather_pairs or a search", [&] {
        PairList list;
        last() ? gather_pairs(*engine_, list) : (void)engine_->find_pairs(own(), list, {}, requested_stop());
    });
    const std::vector<Box3d> wide(3);
    expect_on_all(ErrorCode::usage, "the precision",
                  [&] { (void)engine_->count_pairs(last() ? Objects{wide} : own()); });
    const std::vector<double> padding(own_.size(), 0.1);
    expect_on_all(ErrorCode::usage, "the use of padding", [&] {
        (void)engine_->count_pairs(last() ? Objects{own_, padding} : own());
    });
}

TEST_F(RankErrors, AreThoseOfAReceiverOnTheOtherRanks) {
    const auto call = [&] {
        (void)engine_->stream_pairs(own(), [&](std::span<const Pair>) {
            if (last()) throw std::runtime_error("full");
        });
    };
    if (last()) {
        EXPECT_THROW(call(), std::runtime_error);
    } else {
        const auto error = error_of(call);
        ASSERT_TRUE(error);
        EXPECT_EQ(error->what(), "rank " + std::to_string(rank_count() - 1) + ": the receiver of the pairs failed");
    }
    expect_usable();
}

TEST_F(RankErrors, CancelAllWhereOneIsStopped) {
    std::stop_source stop;
    if (last()) stop.request_stop();
    expect_on_all(ErrorCode::cancelled, "cancelled", [&] { (void)engine_->count_pairs(own(), {}, stop.get_token()); });
}

/// Cancels a search that would take many seconds.
TEST_F(RankErrors, CancelAllWhereOneIsStoppedMeanwhile) {
    const std::vector<Box3f> many(60'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    for (const Order order : {Order::octal, Order::ascending}) {
        std::stop_source stop;
        std::jthread stopper;
        if (last()) {
            stopper = std::jthread([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                stop.request_stop();
            });
        }
        Options options{.order = order};
        PairList list;
        expect_on_all(ErrorCode::cancelled, "cancelled", [&] {
            (void)engine_->find_pairs({many, {}}, list, options, stop.get_token());
        });
    }
}

/// A cancelled stream leaves no limit of its buffer behind.
TEST_F(RankErrors, AreNoneAfterACancelledStream) {
    const std::vector<Box3f> many(60'000, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::stop_source stop;
    Options options{.order = Order::ascending};
    options.progress = [&](double done) {
        if (done >= 0.29 && last()) stop.request_stop();  // the octree is built: pairs are listed next
    };
    const PairSink ignore = [](std::span<const Pair>) {};
    expect_on_all(ErrorCode::cancelled, "cancelled", [&] {
        (void)engine_->stream_pairs(Objects{many, {}}, ignore, options, stop.get_token());
    });
    const std::vector<Box3f> some(own_rank() == 0 ? 2'000 : 0, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::vector<Pair64> found;
    EXPECT_EQ(find_pairs64(*engine_, IndexedObjects{{some, {}}, {}}, found).pairs, 1'999'000u);
}

TEST_F(RankErrors, AreNoneWhereThereAreFewObjectsOrNone) {
    const Box3f box{{0, 0, 0}, {1, 1, 1}};
    const std::vector<Box3f> one(own_rank() == 0 ? 1 : 0, box);
    PairList list;
    EXPECT_EQ(engine_->find_pairs({std::span<const Box3f>(), {}}, list).pairs, 0u);
    EXPECT_EQ(engine_->find_pairs({one, {}}, list).pairs, 0u);
    const std::vector<Box3f> one_each(1, box);
    const std::uint64_t ranks = rank_count();
    EXPECT_EQ(engine_->find_pairs({one_each, {}}, list).pairs, ranks * (ranks - 1) / 2);
    EXPECT_EQ(all_pieces(list.to_vector()).size(), ranks * (ranks - 1) / 2);
    const std::vector<Box3d> none;
    EXPECT_EQ(engine_->find_pairs(Join{{one, {}}, {none, {}}}, list).pairs, 0u);
}

TEST(RankEngine, RefusesNoCommunicator) {
    EXPECT_THROW((void)make_mpi_engine(MPI_COMM_NULL), Error);
    EXPECT_THROW(
        {
            PairList list;
            gather_pairs(*make_local_engine(), list);
        },
        Error);
}

/// Each half of the ranks has its own scene.
TEST(RankEngine, WorksOnPartOfTheRanks) {
    MPI_Comm half = MPI_COMM_NULL;
    const int colour = int(own_rank() % 2);
    MPI_Comm_split(MPI_COMM_WORLD, colour, int(own_rank()), &half);
    {
        const std::vector<Box3f> boxes = samples::make_scene("dense", 3'000, std::uint64_t(colour));
        int rank = 0, ranks = 0;
        MPI_Comm_rank(half, &rank);
        MPI_Comm_size(half, &ranks);
        const std::vector<Box3f> own(boxes.begin() + std::ptrdiff_t(boxes.size()) * rank / ranks,
                                     boxes.begin() + std::ptrdiff_t(boxes.size()) * (rank + 1) / ranks);
        const auto engine = make_mpi_engine(half);
        PairList list;
        (void)engine->find_pairs({own, {}}, list);
        gather_pairs(*engine, list);
        const std::vector<Pair> expected = rank == 0 ? find_pairs(boxes) : std::vector<Pair>();
        EXPECT_TRUE(same_bytes(list.to_vector(), expected));
    }
    MPI_Comm_free(&half);
}

}  // namespace
}  // namespace octopair::test
