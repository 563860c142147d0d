// Tests objects that end during activity: a client's engine with running jobs, a server with running calls.
#include <gtest/gtest.h>

#include <thread>

#include "engine/jobs.hpp"
#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/served.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

class ServedLifetimes : public ::testing::Test {
protected:
    Gate gate_;
    Served served_{[this](service::ServerOptions& options) {
        options.engine = gated_engines(gate_);
        options.engine_widths.instant = 0;  // instant jobs would block gRPC's threads at the gate
        options.stall = std::chrono::hours(10);
    }};
    const std::vector<Box3f> few_ = make_boxes("dense", 100, 1);
    const std::vector<Box3f> many_ = make_boxes("dense", 60'000, 1);
};

TEST_F(ServedLifetimes, AnEngineEndsWithItsJobs) {
    std::vector<Job> jobs;
    {
        const auto engine = served_.client(), other = served_.client();
        for (const auto* boxes : {&many_, &few_, &many_}) jobs.push_back(engine->submit(*boxes));
        jobs.push_back(other->submit(few_));
        ASSERT_TRUE(gate_.wait_for(2));
    }
    for (const Job& job : jobs) EXPECT_EQ(job.state(), JobState::cancelled);
    EXPECT_TRUE(served_.comes_to_rest());
}

TEST_F(ServedLifetimes, AServerEndsWithItsCalls) {
    for (int i = 0; i < int(scaled(20, 4)); ++i) {
        const auto engine = served_.client(milliseconds(0)), other = served_.client(milliseconds(0));
        const Job job = engine->submit(many_), small = other->submit(few_);
        if (i % 3 != 0) {
            ASSERT_TRUE(gate_.wait_for(i % 3 == 1 ? 1 : 2));
        }
        if (i % 2 == 0) gate_.open();
        served_.stop();
        for (const Job* one : {&job, &small}) {
            ASSERT_TRUE(one->wait_for(minutes(1)));
            EXPECT_NE(one->state(), JobState::cancelled) << "no client cancelled the job";
        }
        gate_.close();
        served_.start();
    }
}

TEST_F(ServedLifetimes, AServerThatComesBackGoesOn) {
    const auto engine = served_.client(), other = served_.client();
    Job job = engine->submit(many_), small = other->submit(few_);
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(gate_.wait_for(2));
        served_.stop();
        served_.start();
    }
    gate_.open();
    EXPECT_EQ(job.take_pairs().to_vector(), listed_pairs(*make_local_engine(2), {many_}));
    EXPECT_GT(small.summary().pairs, 0u);
}

TEST_F(ServedLifetimes, AServerThatDrainsLetsJobsEnd) {
    const auto engine = served_.client(), other = served_.client();
    Job job = engine->submit(many_), small = other->submit(few_);
    ASSERT_TRUE(gate_.wait_for(2));
    std::jthread drain([&] { served_.server().drain(); });
    std::this_thread::sleep_for(milliseconds(50));
    gate_.open();
    EXPECT_GT(job.summary().pairs, 0u);
    EXPECT_GT(small.summary().pairs, 0u);
}

TEST_F(ServedLifetimes, LeaveNothingBehind) {
    gate_.open();
    check_serves(served_.address());
    served_.stop();
    const auto count = [] { return Belongings::now().descriptors; };
    const std::size_t before = count();
    for (int i = 0; i < 10; ++i) {
        served_.start();
        check_serves(served_.address());
        served_.stop();
    }
    EXPECT_TRUE(comes_true([&] { return count() <= before + 2; }, minutes(1))) << count() << " after " << before;
}

}  // namespace
}  // namespace octopair::test
