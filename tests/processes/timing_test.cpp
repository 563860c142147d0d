// Tests deadlines: detection of stopped workers, cancellation, and the exit of workers whose application has ended.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <thread>

#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "support/cancel_time.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

class WorkerTiming : public Processes {};

TEST_F(WorkerTiming, LostWorkersAreReplacedWithinASecond) {
    const Scene scene("clustered", 14'000, 1);
    MappedPlan plan;
    const auto engine = make_faulty_engine(3);
    (void)ask(*engine, scene, {});
    constexpr milliseconds patience(sanitized ? 10000 : 1000);
    for (const FaultKind kind : {FaultKind::kill, FaultKind::crash, FaultKind::stop}) {
        for (const Step step : {Step::encode, Step::scan}) {
            Clock::duration took{};
            for (int attempt = 0; attempt < 3;
                 ++attempt) {  // a machine that is busy with other work may delay any thread
                plan.set(std::vector<Fault>{{.step = step, .kind = kind}});
                const auto begin = Clock::now();
                (void)ask(*engine, scene, {});
                took = Clock::now() - begin;
                EXPECT_TRUE(plan.empty());
                if (took < patience) break;
            }
            EXPECT_LT(took, patience);
        }
    }
}

class WorkerCancel : public WorkerTiming, public ::testing::WithParamInterface<const char*> {
protected:
    void expect_call_cancelled(Engine& engine, const Scene& scene, const Asked& asked) {
        for (const int delay : {0, 3, 15, 40, 90, 200}) {
            SCOPED_TRACE(asked.describe() + ", after " + std::to_string(delay) + " ms");
            expect_cancelled([&](std::stop_token stop) { (void)ask(engine, scene, asked, stop); }, milliseconds(delay),
                             true);
        }
    }
};

TEST_P(WorkerCancel, IsSoonDone) {
    const bool crowd = std::string(GetParam()) == "coincident";
    const Scene scene(GetParam(), scaled(crowd ? 200'000 : 1'500'000, 10), 1), few("clustered", 5'000, 1);
    const auto engine = make_process_engine(3);
    for (Asked asked : all_ways()) {
        if (crowd && asked.how == How::list) continue;
        for (const bool join : {false, true}) {
            asked.join = join;
            expect_call_cancelled(*engine, scene, asked);
        }
        EXPECT_EQ(ask(*engine, few, asked), ask(*make_local_engine(1), few, asked));
    }
    EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
}

INSTANTIATE_TEST_SUITE_P(, WorkerCancel, ::testing::Values("dense", "rods", "coincident"),
                         [](const auto& tested) { return std::string(tested.param); });

/// The test application (application.cpp) and the ids of its workers.
struct Application {
    explicit Application(const char* how) {
        int ends[2];
        EXPECT_EQ(::pipe(ends), 0);
        id = ::fork();
        if (id == 0) {
            (void)::dup2(ends[1], 1);
            ::close(ends[0]);
            ::close(ends[1]);
            (void)::execl(OCTOPAIR_BAD_APPLICATION, "application", how, nullptr);
            ::_exit(127);
        }
        ::close(ends[1]);
        FILE* const out = ::fdopen(ends[0], "r");
        for (char line[64]; std::fgets(line, sizeof line, out) != nullptr && line[0] != 'd';) {
            workers.push_back(pid_t(std::strtol(line, nullptr, 10)));
        }
        (void)std::fclose(out);
    }

    std::size_t left() const {
        std::size_t living = 0;
        for (const pid_t worker : workers) living += process_lives(worker) ? 1 : 0;
        return living;
    }

    pid_t id = -1;
    std::vector<pid_t> workers;
};

class WorkersOfADeadClient : public WorkerTiming {
protected:
    void expect_gone(const Application& application) {
        EXPECT_EQ(application.workers.size(), 3u);
        EXPECT_TRUE(comes_true([&] { return application.left() == 0; }, milliseconds(10000)))
            << application.left() << " workers are still running";
        for (const pid_t worker : application.workers) (void)::kill(worker, SIGKILL);
    }
    void kill(const Application& application) {
        (void)::kill(application.id, SIGKILL);
        (void)::waitpid(application.id, nullptr, 0);
    }
};

TEST_F(WorkersOfADeadClient, EndWhenItIsKilled) {
    for (const char* how : {"idle", "busy"}) {
        const Application application(how);
        std::this_thread::sleep_for(milliseconds(50));
        EXPECT_EQ(application.left(), 3u);
        kill(application);
        expect_gone(application);
    }
}

TEST_F(WorkersOfADeadClient, EndWhenItExits) {
    const Application application("exit");
    (void)::waitpid(application.id, nullptr, 0);
    expect_gone(application);
}

TEST_F(WorkersOfADeadClient, EndThoughTheyAreStopped) {
    for (const char* how : {"idle", "fork"}) {
        const Application application(how);
        (void)::kill(application.workers.at(1), SIGSTOP);
        std::this_thread::sleep_for(milliseconds(50));
        kill(application);
        expect_gone(application);
    }
}

TEST_F(WorkersOfADeadClient, EndThoughAChildOfItHasTheirSockets) {
    const Application application("fork");
    std::this_thread::sleep_for(milliseconds(50));
    kill(application);
    expect_gone(application);
}

}  // namespace
}  // namespace octopair::test
