// Tests unusual applications: they ignore or wait for all children, receive a signal every millisecond, throw from
// sinks, pass bad boxes, or call from many threads.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "samples/random.hpp"
#include "support/calls.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class Applications : public Processes {
protected:
    /// Makes calls with all kinds of faults.
    void call_with_faults() {
        MappedPlan plan;
        {
            const auto engine = make_faulty_engine(3);
            for (int i = 0; i < 12; ++i) {
                const auto kind = FaultKind(i % 3);
                plan.set(std::vector<Fault>{{.step = Step::encode, .kind = kind}, {.step = Step::scan, .kind = kind}});
                expect_right(*engine, scene_, {.how = i % 2 == 0 ? How::list : How::stream});
            }
            const WorkerFaults faults = worker_faults(*engine);
            EXPECT_EQ(faults.ended, 16u);
            EXPECT_EQ(faults.stopped, 8u);
        }
        EXPECT_TRUE(comes_true([] { return children_of(::getpid()).empty(); }, std::chrono::milliseconds(500)));
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1);
    const Scene scene_{"clustered", 14'000, 1};
};

TEST_F(Applications, MayIgnoreTheirChildren) {
    const auto before = ::signal(SIGCHLD, SIG_IGN);
    call_with_faults();
    (void)::signal(SIGCHLD, before);
}

/// Waits, on another thread, for every child of the process that ends, until the Waiter is destroyed.
class Waiter {
public:
    explicit Waiter(int options)
        : thread_([options](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  int status = 0;
                  while (::waitpid(-1, &status, WNOHANG | options) > 0) {
                  }
                  std::this_thread::sleep_for(std::chrono::microseconds(200));
              }
          }) {}

private:
    std::jthread thread_;
};

TEST_F(Applications, MayWaitForAllChildren) {
    const Waiter waiter(0);
    call_with_faults();
}

TEST_F(Applications, MayWaitForStoppedChildrenToo) {
    const Waiter waiter(WUNTRACED | WCONTINUED);
    call_with_faults();
}

std::atomic<std::uint64_t> timer_signals = 0;

/// Sends a signal every millisecond, which interrupts system calls.
class Interrupter {
public:
    Interrupter() {
        struct sigaction action {};
        action.sa_handler = [](int) { timer_signals.fetch_add(1); };
        (void)::sigaction(SIGALRM, &action, &before_);
        const itimerval every{{0, 1000}, {0, 1000}};
        (void)::setitimer(ITIMER_REAL, &every, nullptr);
    }
    ~Interrupter() {
        const itimerval never{};
        (void)::setitimer(ITIMER_REAL, &never, nullptr);
        (void)::sigaction(SIGALRM, &before_, nullptr);
    }
    Interrupter(const Interrupter&) = delete;
    Interrupter& operator=(const Interrupter&) = delete;

private:
    struct sigaction before_ {};
};

TEST_F(Applications, MayBeInterruptedAllTheTime) {
    const Scene large("uniform", scaled(1'000'000, 10), 1);  // signals interrupt the allocation of the copy
    const Interrupter interrupter;
    call_with_faults();
    const auto engine = make_process_engine(2);
    for (const Asked& asked : all_ways()) expect_right(*engine, large, asked);
    EXPECT_GT(timer_signals.load(), 100u);
}

TEST_F(Applications, GetTheMessageOfTheLocalEngineForABadBox) {
    const auto engine = make_process_engine(3);
    const auto message = [&](Engine& asked_engine, const Scene& scene, const Asked& asked) -> std::string {
        try {
            (void)ask(asked_engine, scene, asked);
        } catch (const Error& error) {
            return std::to_string(int(error.code())) + error.what();
        }
        return "no error";
    };
    samples::RandomStream random(test_seed(1), 1);
    for (int i = 0; i < 30; ++i) {
        Scene bad = scene_;
        for (auto wrong = 1 + random.below(3); wrong > 0; --wrong) {
            const std::size_t index = random.below(bad.first.size());
            bad.first[index].max[random.below(3)] = i % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : -1e30f;
            if (i % 5 == 0) bad.second[index / 2].min[0] = std::numeric_limits<float>::infinity();
            if (i % 7 == 0) bad.padding[index] = -1;
        }
        bad.wide_first = Scene("uniform", 1, 1).wide_first;
        Asked asked = random_call(random.next());
        asked.wide = false;
        SCOPED_TRACE(asked.describe());
        const std::string expected = message(*local_, bad, asked);
        EXPECT_EQ(message(*engine, bad, asked), expected);
        EXPECT_NE(expected, "no error");
    }
    expect_right(*engine, scene_, {});
    EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
}

TEST_F(Applications, MayThrowFromTheirSinks) {
    struct Mine {};
    const Scene scene("world10", 14'000, 1);
    const auto engine = make_process_engine(3);
    for (const Order order : {Order::octal, Order::ascending}) {
        for (const int at : {1, 2, 4}) {
            int calls = 0;
            Options options{.order = order, .buffer_bytes = 0};
            const PairSink sink = [&](std::span<const Pair>) {
                if (++calls == at) throw Mine();
            };
            EXPECT_THROW(engine->stream_pairs(scene.objects({}), sink, options), Mine);
            EXPECT_EQ(calls, at);
            options.progress = [&, told = 0](double) mutable {
                if (++told == std::min(at, 2)) throw Mine();
            };
            PairList list;
            EXPECT_THROW(engine->find_pairs(scene.objects({}), list, options), Mine);
            EXPECT_EQ(list.size(), 0u);
        }
        expect_right(*engine, scene, {.how = How::stream, .order = order});
    }
    EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
}

TEST_F(Applications, SeeProgressWhilePairsAreSorted) {
    using Clock = std::chrono::steady_clock;
    // The workers sort pairs for 0.3 to 0.5 of the time. Meanwhile the client checks them several times.
    const Scene scene("world10", scaled(1'000'000, 20), 1);
    const auto engine = make_process_engine(2);
    PairList list;
    double least = 1;  // least part of a call that passed after the report of 0.85
    for (int call = 0; call < 3; ++call) {
        std::optional<Clock::time_point> nearly_done;
        Options options;
        options.progress = [&](double done) {
            if (done >= 0.85 && !nearly_done) nearly_done = Clock::now();
        };
        const auto begin = Clock::now();
        engine->find_pairs(scene.objects({}), list, options);
        const auto end = Clock::now();
        least = std::min(least, std::chrono::duration<double>(end - nearly_done.value_or(end)) / (end - begin));
    }
    EXPECT_LT(least, 0.25);
}

TEST_F(Applications, MayLimitThePairs) {
    const Scene scene("world10", 14'000, 1);
    const auto engine = make_process_engine(3);
    const std::uint64_t all = ask(*local_, scene, {.how = How::count}).count;
    for (const std::uint64_t limit : {std::uint64_t(0), std::uint64_t(1), all / 2, all - 1, all, all + 1}) {
        for (Asked asked : all_ways()) {
            asked.limit = limit;
            expect_right(*engine, scene, asked);
        }
    }
    EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
}

TEST_F(Applications, MayCallFromManyThreads) {
    const auto engine = make_process_engine(2);
    std::vector<std::jthread> threads;
    for (std::uint64_t i = 0; i < 4; ++i) {
        threads.emplace_back([&, i] {
            for (std::uint64_t call = 0; call < 5; ++call) {
                const Asked asked = random_call(i * 10 + call);
                EXPECT_EQ(ask(*engine, scene_, asked), ask(*make_local_engine(1), scene_, asked));
                (void)worker_faults(*engine);
            }
        });
    }
}

TEST_F(Applications, HaveNoFaultsOfOtherEngines) { EXPECT_THROW((void)worker_faults(*local_), Error); }

}  // namespace
}  // namespace octopair::test
