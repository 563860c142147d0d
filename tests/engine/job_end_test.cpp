// Tests the end of jobs. A job ends exactly once, for any time and source of cancellation. An ended job uses none of
// the caller's data.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>

#include "engine/job_queue.hpp"
#include "engine/job_task.hpp"
#include "engine/jobs.hpp"
#include "samples/scenes.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

bool has_ended(JobState state) {
    return state == JobState::done || state == JobState::failed || state == JobState::cancelled;
}

/// Busy-waits for `time`, which can be shorter than the shortest sleep.
void spin(std::chrono::microseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

void wait_until_running(const Job& job) {
    while (job.state() == JobState::queued) std::this_thread::yield();
}

/// Expects that `job` stays cancelled.
void expect_cancelled(Job& job) {
    ASSERT_TRUE(job.wait_for(seconds(30)));
    EXPECT_EQ(job.state(), JobState::cancelled);
    EXPECT_EQ(code_of([&] { (void)job.summary(); }), ErrorCode::cancelled);
    EXPECT_EQ(code_of([&] { (void)job.take_pairs(); }), ErrorCode::cancelled);
    job.cancel();
    EXPECT_EQ(job.state(), JobState::cancelled);
}

TEST(JobEnds, StatesFollowEachOther) {
    const auto engine = make_local_engine(1);
    HeldJob first(*engine);
    const Job second = engine->submit(touching_boxes);
    EXPECT_EQ(first.job().state(), JobState::running);
    EXPECT_EQ(second.state(), JobState::queued);
    EXPECT_EQ(second.progress(), 0);
    EXPECT_FALSE(second.wait_for(milliseconds(1)));
    first.let_go_on();
    second.wait();
    EXPECT_EQ(first.job().state(), JobState::done);
    EXPECT_EQ(second.state(), JobState::done);
    EXPECT_EQ(second.progress(), 1);
}

TEST(JobEnds, AQueuedJobIsCancelledAtOnceAndLetsGo) {
    const auto engine = make_local_engine(1);
    HeldJob first(*engine);
    const auto token = std::make_shared<int>();
    Job second = engine->submit_stream(touching_boxes, [token](auto) { ADD_FAILURE() << "called after cancellation"; },
                                       {.progress = [token](double) {}});
    EXPECT_GT(token.use_count(), 1);
    second.cancel();
    EXPECT_EQ(second.state(), JobState::cancelled);
    EXPECT_EQ(token.use_count(), 1);
    expect_cancelled(second);
}

TEST(JobEnds, ARunningJobIsCancelled) {
    const auto engine = make_local_engine(2);
    const auto boxes = samples::make_scene("coincident", 300'000, 1);
    for (const int delay : {0, 1, 30}) {
        Job job = engine->submit_stream(borrowed(objects_of(boxes)), {});
        wait_until_running(job);
        std::this_thread::sleep_for(milliseconds(delay));
        job.cancel();
        expect_cancelled(job);
    }
    EXPECT_EQ(engine->submit(touching_boxes).summary().pairs, 1u);
}

TEST(JobEnds, WhatAJobKeptIsGoneWhenItHasEnded) {
    const auto engine = make_local_engine(1);
    const auto token = std::make_shared<int>();
    for (const bool fails : {false, true}) {
        const Job job = engine->submit_stream(touching_boxes,
                                              [token, fails](auto) {
                                                  if (fails) throw 42;
                                              },
                                              {.progress = [token](double) {}});
        job.wait();
        EXPECT_EQ(token.use_count(), 1);
    }
}

TEST(JobEnds, CancellingRacesWithCompletion) {
    const auto engine = make_local_engine(1);
    const auto boxes = samples::make_scene("dense", 500, 1);
    const std::uint64_t pairs = find_pairs(boxes).size();
    const std::uint64_t rounds = scaled(10'000, 5);
    std::uint64_t done = 0, cancelled = 0;
    for (std::uint64_t round = 0; round < rounds; ++round) {
        Job job = engine->submit(boxes);
        spin(std::chrono::microseconds(round % 200));
        job.cancel();
        const JobState at_once = job.state();
        job.wait();
        const JobState last = job.state();
        ASSERT_TRUE(last == JobState::done || last == JobState::cancelled) << int(last);
        if (has_ended(at_once)) {
            ASSERT_EQ(at_once, last);
        }
        if (last == JobState::done) {
            ++done;
            ASSERT_EQ(job.take_pairs().size(), pairs);
            ASSERT_EQ(job.summary().pairs, pairs);
        } else {
            ++cancelled;
            ASSERT_EQ(code_of([&] { (void)job.take_pairs(); }), ErrorCode::cancelled);
        }
        ASSERT_EQ(job.state(), last);
    }
    EXPECT_EQ(done + cancelled, rounds);
    EXPECT_GT(done, 0u);
    EXPECT_GT(cancelled, 0u);
}

TEST(JobEnds, SeveralCancelAtOnceWhileOthersWait) {
    const auto engine = make_local_engine(1);
    const auto boxes = samples::make_scene("dense", 100, 1);
    for (std::uint64_t round = 0; round < scaled(500, 10); ++round) {
        Job job = engine->submit(boxes);
        std::array<JobState, 3> seen{};
        std::vector<std::jthread> threads;
        for (JobState& state : seen) {
            threads.emplace_back([&] {
                job.wait();
                state = job.state();
            });
        }
        for (int i = 0; i < 3; ++i) threads.emplace_back([&] { job.cancel(), job.cancel(); });
        threads.clear();
        for (const JobState state : seen) ASSERT_EQ(state, job.state());
        ASSERT_TRUE(has_ended(job.state()));
    }
}

TEST(JobEnds, ManyCancelledJobsDoNotStayInTheQueue) {
    const auto engine = make_local_engine(1);
    HeldJob held(*engine);  // the following jobs wait for the end of this job
    detail::JobQueue queue(*engine);
    std::vector<Job> kept;
    std::vector<std::weak_ptr<detail::JobTask>> cancelled;
    for (int i = 0; i < 4000; ++i) {
        const auto task = std::make_shared<detail::JobTask>(detail::JobTask::Work{touching_boxes, {}, {}});
        queue.add(task);
        Job job = detail::make_job(task);
        if (i % 40 == 0) {
            kept.push_back(std::move(job));
        } else {
            cancelled.push_back(task);
        }
    }
    const auto stay =
        std::count_if(cancelled.begin(), cancelled.end(), [](const auto& task) { return !task.expired(); });
    EXPECT_LE(stay, 300);
    held.let_go_on();
    for (const Job& job : kept) EXPECT_EQ(job.summary().pairs, 1u);
}

TEST(JobEnds, AnEnginesEndCancelsItsJobs) {
    const auto boxes = samples::make_scene("coincident", 300'000, 1);
    for (const int delay : {0, 20}) {
        auto engine = make_local_engine(2);
        Job done = engine->submit(touching_boxes);
        done.wait();
        Job running = engine->submit_stream(borrowed(objects_of(boxes)), {});
        std::vector<Job> queued;
        for (int i = 0; i < 20; ++i) queued.push_back(engine->submit(touching_boxes));
        if (delay > 0) wait_until_running(running);
        std::this_thread::sleep_for(milliseconds(delay));
        engine.reset();
        EXPECT_EQ(running.state(), JobState::cancelled);
        expect_cancelled(running);
        for (Job& job : queued) expect_cancelled(job);
        EXPECT_EQ(done.state(), JobState::done);
        EXPECT_EQ(done.take_pairs().size(), 1u);
    }
}

TEST(JobEnds, AnEngineMayGoWhileOthersWaitForItsJobs) {
    for (std::uint64_t round = 0; round < scaled(200, 5); ++round) {
        auto engine = make_local_engine(1);
        std::vector<Job> jobs;
        for (int i = 0; i < 5; ++i) jobs.push_back(engine->submit(touching_boxes));
        std::jthread waiter([&] {
            for (const Job& job : jobs) job.wait();
        });
        std::jthread canceller([&] {
            for (Job& job : jobs) job.cancel();
        });
        engine.reset();
        for (const Job& job : jobs) EXPECT_TRUE(has_ended(job.state()));
    }
}

/// `drop` gets a handle of a running job. The job's input and the object of its sink are destroyed when `drop` returns.
void expect_let_go(const std::function<void(Job)>& drop) {
    const auto engine = make_local_engine(2);
    for (const int delay : {0, 0, 1, 5, 20}) {
        auto boxes = std::make_unique<std::vector<Box3f>>(samples::make_scene("coincident", 20'000, 1));
        auto received = std::make_unique<std::uint64_t>(0);
        Job job = engine->submit_stream(borrowed(objects_of(*boxes)),
                                        [sum = received.get()](std::span<const Pair> batch) { *sum += batch.size(); });
        std::this_thread::sleep_for(milliseconds(delay));
        drop(std::move(job));
        for (Box3f& box : *boxes) box.min[0] = box.max[0] + 1;  // invalid: a late read would be an error
        boxes.reset();
        received.reset();
    }
    EXPECT_EQ(engine->submit(touching_boxes).summary().pairs, 1u);
}

TEST(JobEnds, AHandleThatGoesWaitsForBorrowedObjects) {
    expect_let_go([](Job) {});
}

TEST(JobEnds, AHandleThatIsAssignedOverWaitsToo) {
    expect_let_go([](Job job) { job = Job(); });
    expect_let_go([](Job job) {
        Job& same = job;
        job = std::move(same);
        EXPECT_TRUE(job.valid());
    });
}

TEST(JobEnds, AHandleMayGoInItsOwnSink) {
    const auto engine = make_local_engine(1);
    HeldJob first(*engine);
    auto job = std::make_unique<Job>();
    std::atomic<bool> gone = false;
    *job = engine->submit_stream(touching_boxes, [&](auto) {
        job.reset();
        gone = true;
    });
    first.let_go_on();
    engine->submit(touching_boxes).wait();
    EXPECT_TRUE(gone);
}

TEST(JobEnds, ASinkMayOwnItsHandle) {
    const auto engine = make_local_engine(1);
    std::optional<HeldJob> first(std::in_place, *engine);
    for (const bool runs : {false, true}) {
        auto job = std::make_shared<Job>();
        *job = engine->submit_stream(touching_boxes, [job](auto) { job->cancel(); });
        Job* const observed = job.get();
        job.reset();
        if (runs) {
            first.reset();
            engine->submit(touching_boxes).wait();
        } else {
            observed->cancel();
        }
    }
    EXPECT_EQ(engine->submit(touching_boxes).summary().pairs, 1u);
}

/// A direct call that runs until the test releases it.
class HeldCall {
public:
    explicit HeldCall(Engine& engine)
        : caller_([&] {
              (void)engine.stream_pairs(objects_of(touching_boxes), [&](auto) {
                  entered_.release();
                  go_on_.acquire();
              });
          }) {
        entered_.acquire();
    }
    HeldCall(const HeldCall&) = delete;
    HeldCall& operator=(const HeldCall&) = delete;
    ~HeldCall() { go_on_.release(); }

private:
    std::binary_semaphore entered_{0}, go_on_{0};
    std::jthread caller_;
};

TEST(JobEnds, AJobIsCancelledBehindADirectCall) {
    const auto engine = make_local_engine(1);
    const HeldCall held(*engine);
    Job job = engine->submit(touching_boxes);
    wait_until_running(job);
    EXPECT_FALSE(job.wait_for(milliseconds(10)));
    job.cancel();
    expect_cancelled(job);
}

TEST(JobEnds, ADirectCallIsStoppedBehindAJob) {
    const auto engine = make_local_engine(1);
    HeldJob held(*engine);
    std::stop_source stop;
    const std::jthread stopper([&] {
        std::this_thread::sleep_for(milliseconds(10));
        stop.request_stop();
    });
    PairList list;
    const auto call = [&] { engine->find_pairs(objects_of(touching_boxes), list, {}, stop.get_token()); };
    EXPECT_EQ(code_of(call), ErrorCode::cancelled);
    held.let_go_on();
    EXPECT_EQ(engine->count_pairs(objects_of(touching_boxes)), 1u);
}

}  // namespace
}  // namespace octopair::test
