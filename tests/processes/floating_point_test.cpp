// Tests that worker processes find the same pairs for any floating-point state of the caller.
#include <gtest/gtest.h>

#include <cfloat>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "octopair/processes.hpp"
#include "support/compare.hpp"
#include "support/floating_point.hpp"

namespace octopair::test {
namespace {

class WorkerFloatingPoint : public ::testing::TestWithParam<CallerState> {};

TEST_P(WorkerFloatingPoint, ChangesNoPairs) {
    for (const double step : {0.1, DBL_TRUE_MIN}) {
        std::vector<Box3d> boxes;
        for (int i = 0; i < 2000; ++i) {
            const double x = step * double(i % 13), y = step * double(i / 13 % 11), z = step * double(i / 143);
            boxes.push_back({{x, y, z}, {x, y + step * double(i % 2), z}});
        }
        const Objects objects{boxes};
        Options options{.margin = step};
        PairList expected, found;
        make_local_engine(1)->find_pairs(objects, expected, options);
        call_in(GetParam(), [&] { make_process_engine(2)->find_pairs(objects, found, options); });
        EXPECT_FALSE(expected.to_vector().empty());
        EXPECT_TRUE(same_sequence(found.to_vector(), expected.to_vector())) << step;
    }
}

INSTANTIATE_TEST_SUITE_P(States, WorkerFloatingPoint, ::testing::ValuesIn(caller_states()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace octopair::test
