// Tests that an error on one rank ends the call on all ranks with the same Error, and that the engine stays usable.
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"
#include "support/error_place.hpp"
#include "support/reentry.hpp"

namespace octopair::test {
namespace {

using test::own_rank;
using test::rank_count;

class RankErrors : public ::testing::Test {
protected:
    Objects own() const { return {std::span<const Box3f>(own_), {}}; }
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
        ASSERT_TRUE(test::on_all(error.has_value()));
        EXPECT_EQ(int(error->code()), int(code)) << error->what();
        EXPECT_NE(std::string(error->what()).find(message), std::string::npos) << error->what();
        expect_usable();
    }
    void expect_usable() {
        PairList list;
        (void)engine_->find_pairs(own(), list);
        EXPECT_TRUE(test::same_bytes(test::all_pieces(list.to_vector()), expected_));
    }
    bool last() const { return own_rank() + 1 == rank_count(); }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 5'000, 1);
    const std::vector<Pair> expected_ = find_pairs(boxes_);
    std::vector<Box3f> own_ = test::slice(boxes_, test::Spread::even);
    const std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankErrors, NameTheFirstBadBoxOfAllRanks) {
    const std::size_t begin = test::own_slice(boxes_.size(), test::Spread::even).begin;
    std::vector<Box3f> bad = own_;
    // Two bad boxes on each rank. The first of all is on rank 0.
    bad[17].max[1] = std::numeric_limits<float>::quiet_NaN();
    bad[12].min[0] = bad[12].max[0] + 1;
    PairList list;
    expect_on_all(ErrorCode::bad_input, "object 12: min x", [&] {
        (void)engine_->find_pairs({std::span<const Box3f>(bad), {}}, list);
    });
    EXPECT_EQ(list.size(), 0u);
    // Bad boxes on the last rank only: the message has the global index.
    const std::vector<Box3f>& some = last() ? bad : own_;
    const std::size_t of_last = std::size_t(test::largest(last() ? begin + 12 : 0));
    expect_on_all(ErrorCode::bad_input, "object " + std::to_string(of_last) + ": min x", [&] {
        (void)engine_->count_pairs({std::span<const Box3f>(some), {}});
    });
    expect_on_all(ErrorCode::bad_input, "second set: object " + std::to_string(of_last) + ": min x", [&] {
        (void)engine_->count_pairs(Join{own(), {std::span<const Box3f>(some), {}}});
    });
    test::expect_place([&] { (void)engine_->count_pairs({std::span<const Box3f>(some), {}}); }, of_last, 0);
    test::expect_place(
        [&] {
            (void)engine_->count_pairs(Join{own(), {std::span<const Box3f>(some), {}}});
        },
        of_last, 1);
}

TEST_F(RankErrors, RefuseCallsInTheirSinks) {
    bool tried = false;
    (void)engine_->stream_pairs(own(), [&](std::span<const Pair>) {
        if (!std::exchange(tried, true)) test::expect_calls_refused(*engine_);
    });
    EXPECT_GT(test::largest(tried ? 1 : 0), 0u);
    EXPECT_EQ(engine_->count_pairs(own()), engine_->count_pairs(own()));
}

/// With several threads, a progress function runs on other threads than that of the call, too.
TEST_F(RankErrors, RefuseCallsInTheirProgressFunctions) {
    const auto engine = make_mpi_engine(MPI_COMM_WORLD, {.threads = 4});
    const std::vector<Box3f> boxes = test::slice(samples::make_scene("dense", 40'000, 1), test::Spread::even);
    const Objects input{std::span(boxes), {}};
    std::atomic<int> reports = 0;
    const auto try_all = [&](double) {
        ++reports;
        test::expect_calls_refused(*engine);
        std::vector<Pair64> wide;
        PairList gathered;
        test::expect_deadlock_refused([&] { (void)find_pairs64(*engine, IndexedObjects{input, {}}, wide); });
        test::expect_deadlock_refused([&] { gather_pairs(*engine, gathered); });
    };
    PairList pairs;
    (void)engine->find_pairs(input, pairs, {.progress = try_all});
    EXPECT_GT(reports.exchange(0), 0);
    std::vector<Pair64> found;
    (void)find_pairs64(*engine, IndexedObjects{input, {}}, found, {.progress = try_all});
    EXPECT_GT(reports, 0);
    EXPECT_EQ(test::all_pieces(found).size(), test::all_pieces(pairs.to_vector()).size());
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
    expect_on_all(ErrorCode::bad_input, "3 paddings", [&] {
        (void)engine_->count_pairs({std::span<const Box3f>(own_), padding});
    });
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
    std::stop_source stopped;
    stopped.request_stop();
    expect_on_all(ErrorCode::usage, "gather_pairs or a search", [&] {
        PairList list;
        last() ? gather_pairs(*engine_, list) : (void)engine_->find_pairs(own(), list, {}, stopped.get_token());
    });
    const std::vector<Box3d> wide(3);
    expect_on_all(ErrorCode::usage, "the precision", [&] {
        (void)engine_->count_pairs(last() ? Objects{std::span<const Box3d>(wide), {}} : own());
    });
    const std::vector<double> padding(own_.size(), 0.1);
    expect_on_all(ErrorCode::usage, "the use of padding", [&] {
        (void)engine_->count_pairs(last() ? Objects{std::span<const Box3f>(own_), padding} : own());
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
        Options options;
        options.order = order;
        PairList list;
        expect_on_all(ErrorCode::cancelled, "cancelled", [&] {
            (void)engine_->find_pairs({std::span<const Box3f>(many), {}}, list, options, stop.get_token());
        });
    }
}

TEST_F(RankErrors, AreNoneWhereThereAreFewObjectsOrNone) {
    const Box3f box{{0, 0, 0}, {1, 1, 1}};
    const std::vector<Box3f> one(own_rank() == 0 ? 1 : 0, box);
    PairList list;
    EXPECT_EQ(engine_->find_pairs({std::span<const Box3f>(), {}}, list).pairs, 0u);
    EXPECT_EQ(engine_->find_pairs({std::span<const Box3f>(one), {}}, list).pairs, 0u);
    const std::vector<Box3f> one_each(1, box);
    const std::uint64_t ranks = rank_count();
    EXPECT_EQ(engine_->find_pairs({std::span<const Box3f>(one_each), {}}, list).pairs, ranks * (ranks - 1) / 2);
    EXPECT_EQ(test::all_pieces(list.to_vector()).size(), ranks * (ranks - 1) / 2);
    const std::vector<Box3d> none;
    EXPECT_EQ(
        engine_->find_pairs(Join{{std::span<const Box3f>(one), {}}, {std::span<const Box3d>(none), {}}}, list).pairs,
        0u);
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
        (void)engine->find_pairs({std::span<const Box3f>(own), {}}, list);
        gather_pairs(*engine, list);
        const std::vector<Pair> expected = rank == 0 ? find_pairs(boxes) : std::vector<Pair>();
        EXPECT_TRUE(test::same_bytes(list.to_vector(), expected));
    }
    MPI_Comm_free(&half);
}

}  // namespace
}  // namespace octopair::test
