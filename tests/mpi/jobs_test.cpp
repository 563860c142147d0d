// Tests jobs of the MPI engine: submitted on all ranks, cancelled on any rank.
#include <gtest/gtest.h>

#include "mpi/ranks.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class RankJobs : public ::testing::Test {
protected:
    JobObjects own() const { return borrowed({own_, {}}); }
    bool last() const { return own_rank() + 1 == rank_count(); }
    void expect_right(Job& job) {
        PairList pairs = job.take_pairs();
        EXPECT_TRUE(same_bytes(all_pieces(pairs.to_vector()), expected_));
    }
    /// Returns objects whose detection takes seconds.
    JobObjects slow() const { return borrowed({many_, {}}); }

    const std::vector<Box3f> boxes_ = samples::make_scene("dense", 5'000, 1);
    const std::vector<Pair> expected_ = find_pairs(boxes_);
    const std::vector<Box3f> own_ = slice(boxes_, Spread::even);
    const std::vector<Box3f> many_{60'000, Box3f{{0, 0, 0}, {1, 1, 1}}};
    std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankJobs, RunInTurnWithCalls) {
    std::vector<Job> jobs;
    for (int i = 0; i < 4; ++i) {
        jobs.push_back(engine_->submit(own()));
        EXPECT_EQ(all_pieces(listed_pairs(*engine_, {own_, {}})).size(), expected_.size());
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
    const std::vector<Box3f> own = slice(samples::make_scene("dense", scaled(100'000, 4), 1), Spread::even);
    double last = 0;
    unsigned after_scan = 0;
    Options options;
    options.progress = [&](double done) {
        EXPECT_GE(done, last);
        last = done;
        after_scan += done > 0.81 && done < 0.99 ? 1 : 0;
    };
    PairList pairs;
    engine_->find_pairs({own}, pairs, options);
    EXPECT_EQ(last, 1);
    EXPECT_GE(after_scan, 1u);
}

TEST_F(RankJobs, ReportTheSameErrorOnAllRanks) {
    std::vector<Box3f> bad = own_;
    if (last()) bad.back().max[2] = -1;
    Job job = engine_->submit(borrowed({bad, {}}));
    const std::string message = error_of(ErrorCode::bad_input, [&] { (void)job.take_pairs(); });
    EXPECT_TRUE(message.starts_with("object 4999:")) << message;
}

}  // namespace
}  // namespace octopair::test
