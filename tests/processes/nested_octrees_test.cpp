// Tests nested octrees of large octants, which workers build together. The pairs equal those of the local engine, even
// if workers are lost during a build.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "octopair/processes.hpp"
#include "processes/asked.hpp"
#include "processes/fault_plan.hpp"
#include "processes/leftovers.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/families.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t objects = 60'000;
constexpr std::uint64_t max_pairs = 2'000'000;
constexpr unsigned worker_count = 2;
constexpr std::uint32_t octree_blocks = 2 * worker_count;  // shares of encode of the outermost octree

class NestedOctrees : public Processes {};

TEST_F(NestedOctrees, OfWorkersAreThoseOfThreads) {
    const Scene scene("speck", objects, 1);
    for (const unsigned count : {1u, 2u, 3u}) {
        SCOPED_TRACE(std::to_string(count) + " workers");
        const auto engine = make_process_engine(count);
        for (const Asked& asked : all_ways()) expect_right(*engine, scene, asked);
        for (const Order order : {Order::octal, Order::ascending}) {
            expect_right(*engine, scene, {.order = order, .wide = true, .margin = 1e-10});
        }
    }
}

TEST_F(NestedOctrees, OfJoinsAreThoseOfThreads) {
    const Scene scene("speck", objects, 2);
    for (const unsigned count : {2u, 3u}) {
        SCOPED_TRACE(std::to_string(count) + " workers");
        const auto engine = make_process_engine(count);
        for (const Order order : {Order::octal, Order::ascending}) {
            expect_right(*engine, scene, {.order = order, .join = true});
            expect_right(*engine, scene, {.how = How::stream, .order = order, .windows = true, .join = true});
        }
    }
}

TEST_F(NestedOctrees, OfClustersWithinClustersAreThoseOfThreads) {
    const auto local = make_local_engine(1), two = make_process_engine(2), three = make_process_engine(3);
    const std::uint64_t first = test_seed(1);
    for (std::uint64_t seed = first; seed < first + scaled(10, 5); ++seed) {
        const Case a_case = make_family_case("nested", objects, seed);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        if (AnyCall{a_case, Order::octal, false, false}.counted_by(*local) > max_pairs) continue;
        for (const Order order : {Order::octal, Order::ascending}) {
            const AnyCall call{a_case, order, false, false};
            const auto expected = call.made_by(*local);
            EXPECT_TRUE(same_bytes(call.made_by(*two), expected));
            EXPECT_TRUE(same_bytes(call.made_by(*three), expected));
        }
    }
}

/// Returns faults in steps of nested octrees, but not of the outermost octree.
std::vector<Fault> nested_faults() {
    std::vector<Fault> faults;
    for (const FaultKind kind : {FaultKind::kill, FaultKind::crash, FaultKind::stop}) {
        for (const Moment moment : {Moment::begin, Moment::end}) {
            for (const std::uint32_t later : {0u, 2u}) {
                faults.push_back({Step::encode, kind, moment, 0, octree_blocks + later});
            }
            faults.push_back({Step::count, kind, moment, 0, 1});
        }
    }
    return faults;
}

TEST_F(NestedOctrees, SurviveWorkersThatAreLostWhileTheyBuildThem) {
    const Scene scene("speck", objects, 3);
    MappedPlan plan;
    const auto local = make_local_engine(1), engine = make_faulty_engine(worker_count);
    constexpr std::array calls = {
        Asked{.how = How::list, .order = Order::octal}, Asked{.how = How::list, .order = Order::ascending},
        Asked{.how = How::stream, .order = Order::octal},
        Asked{.how = How::stream, .order = Order::ascending, .windows = true}, Asked{.how = How::count}};
    std::vector<Answer> expected;
    expected.reserve(calls.size());
    for (const Asked& asked : calls) expected.push_back(ask(*local, scene, asked));
    const std::vector<Fault> faults = nested_faults();
    for (std::size_t i = 0; i < faults.size(); ++i) {
        // Every second time, the next worker that begins a share of that step is also lost.
        std::vector<Fault> planned(1 + i % 2, faults[i]);
        if (planned.size() > 1) planned[1].pass_by = 0;
        plan.set(planned);
        SCOPED_TRACE("fault " + std::to_string(i) + ": " + calls[i % calls.size()].describe());
        expect_same(ask(*engine, scene, calls[i % calls.size()]), expected[i % calls.size()]);
        EXPECT_TRUE(plan.empty()) << "too few shares of nested octrees";
    }
}

}  // namespace
}  // namespace octopair::test
