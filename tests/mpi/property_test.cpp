// Ranks against threads, on random calls about random and degenerate scenes: joins, paddings, margins, limits.
#include <gtest/gtest.h>

#include "mpi/ranks.hpp"
#include "support/any_call.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair {
namespace {

using testing::AnyCall;
using testing::Case;
using testing::Spread;

class RankProperty : public ::testing::TestWithParam<std::string> {
protected:
    void check(const Case& whole, Spread spread) {
        const Case own = testing::slice(whole, spread);
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const bool limited : {false, true}) {
                for (const bool streamed : {false, true}) {
                    const AnyCall expected{whole, order, streamed, limited}, asked{own, order, streamed, limited};
                    EXPECT_TRUE(
                        testing::same_bytes(testing::all_pieces(asked.made_by(*engine_)), expected.made_by(*local_)));
                    EXPECT_EQ(asked.counted_by(*engine_), expected.counted_by(*local_));
                }
            }
        }
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1);
    const std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_P(RankProperty, AgreesWithThreads) {
    for (std::uint64_t i = 0; i < testing::case_count(testing::scaled(6, 3)); ++i) {
        const std::uint64_t seed = testing::case_seed(GetParam(), i);
        const Case whole = testing::make_case(GetParam(), seed);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ": " + whole.describe());
        check(whole, testing::spreads[i % 3]);
        if (HasFailure()) break;
    }
}

/// With more objects, so that every rank has octants of its own.
TEST_P(RankProperty, AgreesWithThreadsOnLargerScenes) {
    if (GetParam() == "denormals" || GetParam() == "largest") GTEST_SKIP() << "seconds a call, for any engine";
    Case whole;
    whole.first.boxes = testing::make_double_boxes(GetParam(), 13'000, testing::case_seed(GetParam(), 0));
    const AnyCall count{whole, Order::octal, false, false};
    if (count.counted_by(*local_) > testing::scaled(1'000'000, 8)) GTEST_SKIP() << "too many pairs";
    const Case own = testing::slice(whole, Spread::even);
    for (const Order order : {Order::octal, Order::ascending}) {
        const AnyCall expected{whole, order, false, false}, asked{own, order, false, false};
        EXPECT_TRUE(testing::same_bytes(testing::all_pieces(asked.made_by(*engine_)), expected.made_by(*local_)));
    }
}

INSTANTIATE_TEST_SUITE_P(, RankProperty, ::testing::ValuesIn(testing::all_kind_names()), testing::param_name);

}  // namespace
}  // namespace octopair
