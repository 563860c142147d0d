// Tests unplanned losses of workers: between calls, all together, at random times, and repeatedly during the same work.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <mutex>
#include <thread>

#include "engine/processes/worker_timeouts.hpp"
#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "samples/random.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using std::chrono::milliseconds;

class WorkerLosses : public Processes {};

/// Sends `signal` to at most `most` workers of this process, from number `choice` on. Returns whether workers exist.
bool signal_workers(int signal, std::size_t most = 1000, std::uint64_t choice = 0) {
    const auto workers = children_of(::getpid());
    for (std::size_t i = 0; i < std::min(most, workers.size()); ++i) {
        (void)::kill(workers[(i + choice) % workers.size()], signal);
    }
    return !workers.empty();
}

TEST_F(WorkerLosses, BetweenCallsAreMadeGood) {
    const Scene scene("clustered", 16'000, 1);
    const auto engine = make_process_engine(3);
    std::uint64_t ended = 0, stopped = 0;
    for (const int signal : {SIGKILL, SIGSTOP, SIGTERM, SIGSEGV}) {
        for (const std::size_t most : {1u, 3u}) {
            ASSERT_TRUE(signal_workers(signal, most));
            std::this_thread::sleep_for(milliseconds(50));
            (signal == SIGSTOP ? stopped : ended) += most;
            expect_right(*engine, scene, {.how = How::list, .order = Order::ascending});
            expect_right(*engine, scene, {.how = How::stream, .order = Order::octal, .windows = true});
        }
    }
    const WorkerFaults faults = worker_faults(*engine);
    EXPECT_EQ(faults.ended, ended);
    EXPECT_EQ(faults.stopped, stopped);
    EXPECT_EQ(faults.in_share, decltype(faults.in_share){});
}

TEST_F(WorkerLosses, AtTheSameShareFailTheCallAlone) {
    const Scene scene("clustered", 6'000, 1);  // few enough objects for one worker
    MappedPlan plan;
    const auto engine = make_faulty_engine(3);
    for (const Step step : {Step::encode, Step::count, Step::scan, Step::order}) {
        for (const FaultKind kind : {FaultKind::kill, FaultKind::crash, FaultKind::stop}) {
            const Asked asked{.how = How::list, .order = Order::ascending};
            const Fault fault{
                .step = step, .kind = kind, .moment = kind == FaultKind::kill ? Moment::begin : Moment::end};
            plan.set(std::vector<Fault>(3, fault));
            expect_error(ErrorCode::engine_failed, step_names[std::size_t(step)],
                         [&] { (void)ask(*engine, scene, asked); });
            expect_right(*engine, scene, asked);
            plan.set(std::vector<Fault>(2, fault));
            expect_right(*engine, scene, asked);
            EXPECT_TRUE(plan.empty());
        }
    }
}

TEST_F(WorkerLosses, FailuresWithoutAMessageAreDescribed) {
    const Scene scene("clustered", 6'000, 1);
    MappedPlan plan;
    const auto engine = make_faulty_engine(2);
    for (const Step step : {Step::encode, Step::count, Step::scan}) {
        plan.set(std::vector<Fault>{{.step = step, .kind = FaultKind::mute}});
        EXPECT_EQ(error_of(ErrorCode::engine_failed, [&] { (void)ask(*engine, scene, {}); }),
                  "a worker process failed without an error message");
        expect_right(*engine, scene, {});
    }
}

TEST_F(WorkerLosses, OfTheFirstBlockOfAStreamThatWasDelivered) {
    const Scene scene("world10", 6'000, 1);
    MappedPlan plan;
    const auto engine = make_faulty_engine(2);
    for (const Order order : {Order::octal, Order::ascending}) {
        for (std::uint32_t ticks = 0; ticks < 12; ++ticks) {
            const Fault fault{.step = Step::scan, .moment = Moment::tick, .ticks = ticks, .pass_by = ticks / 2};
            plan.set(std::vector<Fault>(2, fault));
            expect_right(*engine, scene, {.how = How::stream, .order = order, .windows = true});
        }
    }
}

/// Sends signals to workers from another thread at random times. Sends fewer signals in a call than the number of
/// workers that a share may lose, because on a busy machine a share can last for several pauses.
class Disturber {
public:
    Disturber(int signal, std::size_t at_once, milliseconds pause, std::uint64_t seed)
        : thread_([=, this](std::stop_token stop) {
              samples::RandomStream random(seed, 5);
              while (!stop.stop_requested()) {
                  std::this_thread::sleep_for(pause + milliseconds(random.below(20)));
                  const std::lock_guard lock(mutex_);
                  if (left_ == 0) continue;
                  --left_;
                  (void)signal_workers(signal, at_once, random.below(8));
              }
          }) {}

    void begin_call() {
        const std::lock_guard lock(mutex_);
        left_ = worker_failures::max_deaths_per_share - 1;
    }

private:
    std::mutex mutex_;
    unsigned left_ = 0;  // signals that remain in this call
    std::jthread thread_;
};

class Disturbed : public WorkerLosses {
protected:
    void call_while_disturbed(int signal, std::size_t at_once) {
        const std::uint64_t seed = test_seed(1);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const std::array scenes = {Scene("rods", 13'000, seed), Scene("crowd", 13'000, seed),
                                   Scene("speck", 40'000, seed)};
        const auto engine = make_process_engine(3);
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
        {
            const milliseconds pause(at_once == 1 ? 60 : 250);
            Disturber disturber(signal, at_once, sanitized ? 5 * pause : pause, seed);
            for (std::uint64_t i = 0; std::chrono::steady_clock::now() < end && !HasFailure(); ++i) {
                const Scene& scene = scenes[i % scenes.size()];
                Asked asked = random_call(seed + i);
                if (scene.kind == "speck") {
                    // With any clearance all objects of the speck are pairs. A share would then last longer than a
                    // worker lives in this test.
                    asked.margin = 0;
                    asked.padded = false;
                }
                disturber.begin_call();
                expect_right(*engine, scene, asked);
            }
        }
        expect_right(*engine, scenes[0], {});
        const WorkerFaults faults = worker_faults(*engine);
        EXPECT_GT(faults.ended + faults.stopped, 0u);
    }
};

TEST_F(Disturbed, ByKillsAtRandomTimes) { call_while_disturbed(SIGKILL, 1); }
TEST_F(Disturbed, ByStopsAtRandomTimes) { call_while_disturbed(SIGSTOP, 1); }
TEST_F(Disturbed, ByTheEndOfAllWorkersAtOnce) { call_while_disturbed(SIGKILL, 3); }

TEST_F(WorkerLosses, OutliveTheEngineNowhere) {
    for (unsigned workers = 1; workers <= 6; ++workers) {
        auto engine = make_process_engine(workers);
        EXPECT_EQ(children_of(::getpid()).size(), workers);
        (void)signal_workers(workers % 2 == 0 ? SIGSTOP : SIGKILL, workers / 2);
        engine = nullptr;
        EXPECT_TRUE(children_of(::getpid()).empty());
    }
}

TEST_F(WorkerLosses, LeaveAListThatOutlivesItsEngine) {
    const Scene scene("clustered", 16'000, 1);
    PairList list;
    (void)make_process_engine(2)->find_pairs(scene.objects({}), list);
    std::vector<Pair> expected = ask(*make_local_engine(1), scene, {.order = Order::ascending}).pairs;
    EXPECT_TRUE(same_bytes(list.to_vector(), expected));
    list = PairList();
}

}  // namespace
}  // namespace octopair::test
