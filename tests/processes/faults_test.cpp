// Tests more than a thousand faults, at every step of every kind of call. The pairs equal those of the local engine,
// and the engine's count of lost workers equals that of the plan, fault by fault.
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed>, with the same test.
#include <gtest/gtest.h>

#include <numeric>

#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "samples/random.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

using samples::RandomStream;

constexpr std::array fault_steps = {Step::encode, Step::count, Step::scan, Step::order};
constexpr std::uint64_t faults_a_case = scaled(115, 8);
constexpr unsigned max_faults_per_call = 2;  // per call: a third fault in one share would end the call
constexpr unsigned max_tries = 20;

/// The calls and objects of a case.
struct FaultCase {
    const char* name;
    const char* scene;
    std::uint64_t objects;
    unsigned workers;
    How how;
    Order order;
    bool windows = false;
};

void PrintTo(const FaultCase& a_case, std::ostream* out) { *out << a_case.name; }

Fault random_fault(Step step, RandomStream& random) {
    Fault fault{.step = step,
                .kind = FaultKind(random.below(3)),
                .moment = Moment(random.below(moments)),
                .ticks = std::uint32_t(random.below(random.below(2) == 0 ? 2 : 30)),
                .pass_by = step == Step::scan || step == Step::order ? std::uint32_t(random.below(60)) : 0};
    return fault;
}

/// Returns faults for a call, in the order of the steps.
std::vector<Fault> random_faults(bool ordered, RandomStream& random) {
    std::vector<Fault> faults;
    for (const Step step : fault_steps) {
        if (step == Step::order && !ordered) continue;
        for (auto i = random.below(max_faults_per_call + 1); i > 0; --i) faults.push_back(random_fault(step, random));
    }
    return faults;
}

class Faults : public Processes, public ::testing::WithParamInterface<FaultCase> {
protected:
    /// Makes a call repeatedly until all faults that were planned for it have been taken.
    void fail_within(Engine& engine, const Asked& asked, std::span<const Fault> faults) {
        const auto local = make_local_engine(2);
        const Answer expected = ask(*local, scene_, asked);
        plan_.set(faults);
        for (unsigned tries = 0; !plan_.empty() && tries < max_tries; ++tries) {
            expect_same(ask(engine, scene_, asked), expected);
        }
        plan_.set({});
    }

    /// Expects that the engine counted exactly the faults that happened.
    void expect_accounted(const Engine& engine) {
        const FaultCounts happened = plan_.happened();
        const WorkerFaults counted = worker_faults(engine);
        std::uint64_t ended = 0, stopped = 0;
        for (std::size_t step = 0; step < happened.size(); ++step) {
            const auto [kills, crashes, stops] = happened[step];
            EXPECT_EQ(counted.in_share[step], kills + crashes + stops) << step_names[step];
            ended += kills + crashes;
            stopped += stops;
        }
        EXPECT_EQ(counted.ended, ended);
        EXPECT_EQ(counted.stopped, stopped);
    }

    /// Expects that every kind of fault happened in every step of the calls.
    void expect_all_kinds(bool ordered) {
        if (sanitized) return;
        const FaultCounts happened = plan_.happened();
        for (const Step step : fault_steps) {
            if (step == Step::order && !ordered) continue;
            for (const std::uint64_t count : happened[std::size_t(step)]) {
                EXPECT_GT(count, 0u) << step_names[std::size_t(step)];
            }
        }
    }

    std::uint64_t happened() const {
        std::uint64_t all = 0;
        for (const auto& kinds : plan_.happened()) all = std::accumulate(kinds.begin(), kinds.end(), all);
        return all;
    }

    MappedPlan plan_;
    Scene scene_{GetParam().scene, GetParam().objects, 1};
};

TEST_P(Faults, ChangeNoPair) {
    const std::uint64_t seed = test_seed(1);
    SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
    const FaultCase& a_case = GetParam();
    const bool ordered = a_case.order == Order::ascending && a_case.how != How::count;
    const auto engine = make_faulty_engine(a_case.workers);
    for (std::uint64_t call = 0; happened() < faults_a_case && !HasFailure(); ++call) {
        ASSERT_LT(call, 50 * faults_a_case) << "too few faults happen";
        RandomStream random(seed, call);
        Asked asked = random_call(random.next());
        asked.how = a_case.how;
        asked.order = a_case.order;
        asked.windows = a_case.windows;
        SCOPED_TRACE("call " + std::to_string(call) + ": " + asked.describe());
        fail_within(*engine, asked, random_faults(ordered, random));
    }
    expect_accounted(*engine);
    expect_all_kinds(ordered);
    RecordProperty("faults", int(happened()));
}

/// A worker that is killed before, within or after the commit of a share: no pair is lost or doubled, in any kind of output.
TEST_P(Faults, AtEachMomentOfACommit) {
    const FaultCase& a_case = GetParam();
    const auto engine = make_faulty_engine(a_case.workers);
    const Asked asked{.how = a_case.how, .order = a_case.order, .windows = a_case.windows};
    for (const Moment moment : {Moment::before_commit, Moment::in_commit, Moment::end}) {
        for (const std::uint32_t share : {0u, 1u, 4u}) {
            const Fault fault{.step = Step::scan, .kind = FaultKind::kill, .moment = moment, .pass_by = share};
            SCOPED_TRACE("moment " + std::to_string(unsigned(moment)) + ", share " + std::to_string(share));
            fail_within(*engine, asked, {&fault, 1});
        }
    }
    expect_accounted(*engine);
    for (const Moment moment : {Moment::before_commit, Moment::in_commit, Moment::end}) {
        EXPECT_GT(plan_->in_scan.at(std::size_t(moment)).load(), 0u) << unsigned(moment);
    }
}

INSTANTIATE_TEST_SUITE_P(
    , Faults,
    ::testing::Values(FaultCase{"ListOctal", "uniform", 16'000, 3, How::list, Order::octal},
                      FaultCase{"ListOctalOfACrowd", "crowd", 14'000, 2, How::list, Order::octal},
                      FaultCase{"ListAscending", "clustered", 16'000, 3, How::list, Order::ascending},
                      FaultCase{"ListAscendingOfACrowd", "crowd", 14'000, 3, How::list, Order::ascending},
                      FaultCase{"StreamOctal", "rods", 16'000, 3, How::stream, Order::octal, true},
                      FaultCase{"StreamOctalByOne", "clustered", 8'000, 1, How::stream, Order::octal, true},
                      FaultCase{"StreamAscending", "rods", 13'000, 2, How::stream, Order::ascending},
                      FaultCase{"StreamWindows", "world10", 16'000, 3, How::stream, Order::ascending, true},
                      FaultCase{"Count", "uniform", 21'000, 5, How::count, Order::octal}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace octopair::test
