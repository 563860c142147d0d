// Tests jobs of the MPI engine: submitted on all ranks, cancelled on any rank.
#include <gtest/gtest.h>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"
#include "support/compare.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class RankJobs : public ::testing::Test {
protected:
    JobObjects own() const { return borrowed({std::span<const Box3f>(own_), {}}); }
    bool last() const { return test::own_rank() + 1 == test::rank_count(); }
    void expect_right(Job& job) {
        PairList pairs = job.take_pairs();
        EXPECT_TRUE(test::same_bytes(test::all_pieces(pairs.to_vector()), expected_));
    }
    /// Returns objects whose detection takes seconds.
    JobObjects slow() const { return borrowed({std::span<const Box3f>(many_), {}}); }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 5'000, 1);
    const std::vector<Pair> expected_ = find_pairs(boxes_);
    const std::vector<Box3f> own_ = test::slice(boxes_, test::Spread::even);
    const std::vector<Box3f> many_{60'000, Box3f{{0, 0, 0}, {1, 1, 1}}};
    std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankJobs, RunInTurnWithCalls) {
    std::vector<Job> jobs;
    for (int i = 0; i < 4; ++i) {
        jobs.push_back(engine_->submit(own()));
        PairList list;
        (void)engine_->find_pairs({std::span<const Box3f>(own_), {}}, list);
        EXPECT_EQ(test::all_pieces(list.to_vector()).size(), expected_.size());
        jobs.push_back(engine_->submit(own()));
    }
    for (Job& job : jobs) expect_right(job);
}

/// One rank cancels a running and a waiting job. Both end on all ranks.
TEST_F(RankJobs, EndOnAllWhereOneRankCancels) {
    Job running = engine_->submit(slow());
    Job waiting = engine_->submit(own());
    Job after = engine_->submit(own());
    if (last()) {
        waiting.cancel();
        running.cancel();
    }
    EXPECT_THROW((void)running.take_pairs(), Error);
    EXPECT_EQ(int(running.state()), int(JobState::cancelled));
    EXPECT_THROW((void)waiting.take_pairs(), Error);
    EXPECT_EQ(int(waiting.state()), int(JobState::cancelled));
    expect_right(after);
}

TEST_F(RankJobs, AreCancelledByTheEndOfTheEngine) {
    Job running = engine_->submit(slow());
    std::vector<Job> waiting;
    waiting.reserve(3);
    for (int i = 0; i < 3; ++i) waiting.push_back(engine_->submit(own()));
    engine_.reset();
    EXPECT_EQ(int(running.state()), int(JobState::cancelled));
    for (const Job& job : waiting) EXPECT_EQ(int(job.state()), int(JobState::cancelled));
}

TEST_F(RankJobs, ProgressGrowsWhilePairsAreSorted) {
    const std::vector<Box3f> own =
        test::slice(samples::make_scene("dense", test::scaled(100'000, 4), 1), test::Spread::even);
    double last = 0;
    unsigned after_scan = 0;
    Options options;
    options.progress = [&](double done) {
        EXPECT_GE(done, last);
        last = done;
        after_scan += done > 0.81 && done < 0.99 ? 1 : 0;
    };
    PairList pairs;
    engine_->find_pairs(Objects{std::span<const Box3f>(own), {}}, pairs, options);
    EXPECT_EQ(last, 1);
    EXPECT_GE(after_scan, 1u);
}

TEST_F(RankJobs, ReportTheSameErrorOnAllRanks) {
    std::vector<Box3f> bad = own_;
    if (last()) bad.back().max[2] = -1;
    Job job = engine_->submit(borrowed({std::span<const Box3f>(bad), {}}));
    try {
        (void)job.take_pairs();
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).substr(0, 12), "object 4999:") << error.what();
    }
}

}  // namespace
}  // namespace octopair::test
