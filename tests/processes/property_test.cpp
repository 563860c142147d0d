// Tests workers against threads on random calls with random and degenerate scenes.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "octopair/processes.hpp"
#include "processes/leftovers.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Engines that are reused for all cases, so that state left by a call would show in the next case.
class Engines {
public:
    Engine& local() { return *local_; }
    Engine& workers(unsigned count) {
        std::unique_ptr<Engine>& engine = engines_[count];
        if (!engine) engine = make_process_engine(count);
        return *engine;
    }

private:
    std::unique_ptr<Engine> local_ = make_local_engine(2);
    std::map<unsigned, std::unique_ptr<Engine>> engines_;
};

void check_case(Engines& engines, const Case& a_case, Engine& engine) {
    for (const Order order : {Order::octal, Order::ascending}) {
        for (const bool limited : {false, true}) {
            for (const bool streamed : {false, true}) {
                const AnyCall call{a_case, order, streamed, limited};
                RC_ASSERT(call.made_by(engine) == call.made_by(engines.local()));
                RC_ASSERT(call.counted_by(engine) == call.counted_by(engines.local()));
            }
        }
    }
}

TEST(WorkerProperty, AgreesWithThreads) {
    Engines engines;
    const auto kinds = all_kind_names();
    const bool held = rc::check("workers find what threads find", [&] {
        const auto kind = *rc::gen::elementOf(kinds);
        const auto seed = *rc::gen::arbitrary<std::uint32_t>();
        const auto workers = *rc::gen::inRange(1u, 5u);
        for (std::uint64_t i = 0; i < scaled(8, 8); ++i) {
            const Case a_case = make_case(kind, seed + i);
            RC_LOG() << kind << ", seed " << seed + i << ": " << a_case.describe() << "\n";
            check_case(engines, a_case, engines.workers(workers));
        }
    });
    EXPECT_TRUE(held);
}

constexpr std::uint64_t max_counted_pairs = scaled(1'000'000, 8);

/// Tests the kinds with more objects, so that several workers take part.
TEST(WorkerProperty, AgreesWithThreadsOnLargerScenes) {
    Engines engines;
    std::uint64_t seed = test_seed(1);
    for (const std::string& kind : all_kind_names()) {
        if (kind == "denormals" || kind == "largest") continue;  // a call takes seconds with any engine
        SCOPED_TRACE(kind + ", OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        Case a_case;
        a_case.first.boxes = make_double_boxes(kind, 13'000, seed++);
        const AnyCall count{a_case, Order::octal, false, false};
        if (count.counted_by(engines.local()) > max_counted_pairs) continue;
        Engine& engine = engines.workers(3);
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const bool streamed : {false, true}) {
                const AnyCall call{a_case, order, streamed, false};
                EXPECT_TRUE(same_bytes(call.made_by(engine), call.made_by(engines.local())));
            }
        }
    }
}

}  // namespace
}  // namespace octopair::test
