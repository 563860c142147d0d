// Tests ranks against threads on random calls with random and degenerate scenes: joins, paddings, margins and limits.
#include <gtest/gtest.h>

#include "mpi/ranks.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class RankProperty : public ::testing::TestWithParam<std::string> {
protected:
    void check(const Case& whole, Spread spread) {
        const Case own = slice(whole, spread);
        for (const Order order : {Order::octal, Order::ascending}) {
            for (const bool limited : {false, true}) {
                for (const bool streamed : {false, true}) {
                    const AnyCall expected{whole, order, streamed, limited}, asked{own, order, streamed, limited};
                    EXPECT_TRUE(same_bytes(all_pieces(asked.made_by(*engine_)), expected.made_by(*local_)));
                    EXPECT_EQ(asked.counted_by(*engine_), expected.counted_by(*local_));
                }
            }
        }
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1);
    const std::unique_ptr<Engine> engine_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_P(RankProperty, AgreesWithThreads) {
    for (std::uint64_t i = 0; i < case_count(scaled(6, 3)); ++i) {
        const std::uint64_t seed = case_seed(GetParam(), i);
        const Case whole = make_case(GetParam(), seed);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed) + ": " + whole.describe());
        check(whole, spreads[i % 3]);
        if (HasFailure()) break;
    }
}

/// Uses more objects, so that every rank owns octants.
TEST_P(RankProperty, AgreesWithThreadsOnLargerScenes) {
    if (GetParam() == "denormals" || GetParam() == "largest") GTEST_SKIP() << "each call takes seconds with any engine";
    Case whole;
    const auto pairs_of = [&](std::size_t objects) {
        whole.first.boxes = make_double_boxes(GetParam(), objects, case_seed(GetParam(), 0));
        return AnyCall{whole, Order::octal, false, false}.counted_by(*local_);
    };
    // The first count tells where most boxes overlap: a count of 80 million pairs would take half a minute with a sanitizer.
    constexpr std::uint64_t most = scaled(1'000'000, 8);
    if (pairs_of(1'300) > most / 10 || pairs_of(13'000) > most) GTEST_SKIP() << "too many pairs";
    const Case own = slice(whole, Spread::even);
    for (const Order order : {Order::octal, Order::ascending}) {
        const AnyCall expected{whole, order, false, false}, asked{own, order, false, false};
        EXPECT_TRUE(same_bytes(all_pieces(asked.made_by(*engine_)), expected.made_by(*local_)));
    }
}

INSTANTIATE_TEST_SUITE_P(, RankProperty, ::testing::ValuesIn(all_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
