// Tests workers that write random bytes into the shared tables. The application neither crashes nor hangs. With sound
// workers the same engine then finds the right pairs again.
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed>. The time and place of each write also depend on the
// machine.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Requests a stop after `most`, which must be longer than any call takes.
class Deadline {
public:
    explicit Deadline(std::chrono::seconds most)
        : thread_([this, most](std::stop_token stop) {
              std::mutex mutex;
              std::unique_lock lock(mutex);
              std::condition_variable_any end;
              if (!end.wait_for(lock, stop, most, [] { return false; }) && !stop.stop_requested())
                  source_.request_stop();
          }) {}
    std::stop_token token() const { return source_.get_token(); }
    bool passed() const { return source_.stop_requested(); }

private:
    std::stop_source source_;
    std::jthread thread_;
};

class Damaged : public Processes, public ::testing::WithParamInterface<int> {
protected:
    void TearDown() override {
        ::unsetenv(damage_variable);
        Processes::TearDown();
    }

    void expect_an_end(Engine& engine, const Asked& asked) {
        SCOPED_TRACE(asked.describe());
        const Deadline deadline(std::chrono::seconds(sanitized ? 60 : 15));
        try {
            (void)ask(engine, scene_, asked, deadline.token());
        } catch (const Error& error) {
            EXPECT_GT(std::string(error.what()).size(), 10u);
        }
        EXPECT_FALSE(deadline.passed()) << "the call hangs";
    }

    const Scene scene_{"clustered", 16'000, 1};
};

TEST_P(Damaged, TablesEndNoApplication) {
    const std::uint64_t cases = scaled(20, 10);
    const auto local = make_local_engine(1);
    for (std::uint64_t i = 0; i < cases && !HasFailure(); ++i) {
        const std::uint64_t seed = test_seed(std::uint64_t(GetParam()) * 1000 + i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        ::setenv(damage_variable, std::to_string(seed).c_str(), 1);
        const auto engine = make_faulty_engine(3);
        for (std::uint64_t call = 0; call < 4; ++call) expect_an_end(*engine, random_call(seed * 10 + call));
        ::unsetenv(damage_variable);
        for (const pid_t worker : children_of(::getpid())) (void)::kill(worker, SIGKILL);
        const Asked asked = random_call(seed);
        EXPECT_EQ(ask(*engine, scene_, asked), ask(*local, scene_, asked));
    }
}

INSTANTIATE_TEST_SUITE_P(, Damaged, ::testing::Range(0, 5));

}  // namespace
}  // namespace octopair::test
