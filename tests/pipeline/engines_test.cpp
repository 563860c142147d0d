// Tests that every engine gives the same bytes.
#include <gtest/gtest.h>

#include "octopair/octopair.hpp"
#include "pipeline/flow.hpp"
#ifdef OCTOPAIR_WITH_PROCESSES
#include "octopair/processes.hpp"
#endif

namespace octopair::test {
namespace {

Outcome outcome_of(Engine& engine, const std::vector<Box3f>& boxes, const Options& options) {
    Pipeline pipeline(2);
    pipeline.add(std::make_unique<LotFilter>(3));
    Outcome found;
    pipeline.run(engine, all_of(boxes), into(found), options);
    return found;
}

TEST(PipelineEngines, GiveTheSameBytes) {
    const auto boxes = samples::make_scene("clustered", 20'000, 5);
    std::vector<std::unique_ptr<Engine>> engines;
    engines.push_back(make_local_engine(1));
    engines.push_back(make_local_engine(3));
#ifdef OCTOPAIR_WITH_PROCESSES
    engines.push_back(make_process_engine(2));
#endif
    for (const Order order : {Order::octal, Order::ascending}) {
        for (const std::uint64_t limit : {std::uint64_t(5000), ~std::uint64_t(0)}) {
            Options options{.order = order, .limit = limit, .buffer_bytes = 1 << 20};
            const Outcome expected = outcome_of(*engines[0], boxes, options);
            EXPECT_GE(expected.pairs.size(), 5000u);
            for (std::size_t i = 1; i < engines.size(); ++i) {
                expect_same(outcome_of(*engines[i], boxes, options), expected);
            }
        }
    }
}

}  // namespace
}  // namespace octopair::test
