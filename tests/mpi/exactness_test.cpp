// Tests the MPI engine on small scenes with tiny tuning against brute force, and on large scenes against the second
// algorithm. The ranks of a test share the memory of the test hooks.
#include "exactness/small_scenes.hpp"

#include <gtest/gtest.h>

#include "engine/mpi/leading/leading.hpp"
#include "exactness/large_scenes.hpp"
#include "exactness/tiny_tuning.hpp"
#include "mpi/ranks.hpp"
#include "samples/scenes.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/families.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

TEST(RankExactness, GivesEachPairOnceInLargeScenes) {
    const auto local = make_local_engine(1), ranks = make_mpi_engine(MPI_COMM_WORLD);
    Case long_tails;
    long_tails.first.boxes = long_tailed_boxes(scaled(40'000, 4), 2);
    for (const Case& whole : {long_tails, cloth_case(scaled(120'000, 8), 1)}) {
        const Case own = slice(whole, Spread::lopsided);
        const AnyCall ascending{own, Order::ascending, false, false}, octal{own, Order::octal, false, false};
        EXPECT_TRUE(same_bytes(all_pieces(ascending.made_by(*ranks)), second_algorithm_pairs(whole)));
        const AnyCall alone{whole, Order::octal, false, false};
        EXPECT_TRUE(same_bytes(all_pieces(octal.made_by(*ranks)), alone.made_by(*local)));
    }
}

#ifdef OCTOPAIR_TEST_HOOKS

TEST(RankExactness, StoresTheTopOfTheOctreeAndOwnOctants) {
    if (sanitized) GTEST_SKIP() << "a sanitizer slows a million boxes too much";
    (void)on_all(true);
    if (own_rank() == 0) test_hooks().tuning.ranks.objects_per_octant = 1'000'000;
    (void)on_all(true);
    const std::vector<Box3f> boxes = samples::make_scene("uniform", 1'000'000, 1);
    const auto alone = make_mpi_engine(MPI_COMM_SELF), ranks = make_mpi_engine(MPI_COMM_WORLD);
    const Objects all{boxes, {}};
    const std::uint64_t pairs = alone->count_pairs(all);
    const std::uint64_t whole = last_costs(*alone).octants;
    const std::vector<Box3f> own = slice(boxes, Spread::even);
    EXPECT_EQ(ranks->count_pairs({own}), pairs);
    const std::uint64_t stored = last_costs(*ranks).octants;
    EXPECT_GE(stored, whole / rank_count());
    EXPECT_LE(double(stored), double(whole) * (0.2 + 1.2 / rank_count()));
    (void)on_all(true);
    if (own_rank() == 0) test_hooks().tuning = default_tuning;
    (void)on_all(true);
}

/// Returns fewer scenes than the tests of a single process, by a constant factor.
SceneRange seeds() {
    const SceneRange all = scene_range(SceneSize::small, scaled(10'000, 20));
    return all.size() == 1 ? all : all.part(0, 50 * rank_count());
}
bool are_enough() { return !sanitized && rank_count() > 1 && seeds().size() >= 200; }

/// All ranks make the calls on their slices of a case. Rank 0 sets the tuning. The ranks wait before and after.
class MpiSmallScenes : public ::testing::Test {
protected:
    void set_tuning(const Tuning& tuning) {
        (void)on_all(true);
        if (own_rank() == 0) test_hooks().tuning = tuning;
        (void)on_all(true);
    }

    void check(const Case& whole, const std::vector<Pair>& expected, Spread spread) {
        const Case own = slice(whole, spread);
        for (unsigned way = 0; way < 8; ++way) {
            const Order order = (way & 1) != 0 ? Order::octal : Order::ascending;
            const AnyCall asked{own, order, (way & 2) != 0, (way & 4) != 0};
            const std::vector<Pair> found = all_pieces(asked.made_by(*ranks_));
            // A single process finds the same bytes, and brute force the same set.
            const AnyCall alone{whole, order, false, asked.limited};
            EXPECT_TRUE(same_bytes(found, alone.made_by(*local_)));
            if (!asked.limited && order == Order::ascending) {
                EXPECT_TRUE(same_bytes(found, expected));
            }
            EXPECT_EQ(asked.counted_by(*ranks_), alone.counted_by(*local_));
        }
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1);
    const std::unique_ptr<Engine> ranks_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(MpiSmallScenes, OfSlices) {
    bool good = true;
    for (std::uint64_t seed = seeds().begin; seed < seeds().end && good; ++seed) {
        const Case whole = small_case(seed);
        SCOPED_TRACE("seed " + std::to_string(seed) + ": " + whole.describe());
        set_tuning(tiny_tuning(seed));
        check(whole, brute_force_pairs(whole), spreads[seed % 3]);
        set_tuning(default_tuning);
        good = on_all(!HasFailure());
    }
    if (!are_enough()) return;
    using enum Path;
    EXPECT_EQ(paths_not_taken({ranks_top_divided, ranks_whole_octree, ranks_part_of_octree, ranks_regional,
                               ranks_boxes_sent, object_on_ranks, positions_near, positions_far, ranks_entries_sent,
                               inner_entry_on_rank, inner_entry_on_ranks, ranks_crowd_forecast, ranks_bounds_missing,
                               ranks_pair_postponed, ranks_pair_refused, ranks_window, nested_once}),
              "");
}

/// Makes calls of an engine on rank 0. Other ranks follow that engine.
template <typename Calls>
void lead_engines(const Calls& calls) {
    if (own_rank() != 0) return follow(MPI_COMM_WORLD);
    const std::shared_ptr<Engine> leading = make_leading_engine(MPI_COMM_WORLD), local = make_local_engine(2);
    calls([=](unsigned threads) -> Engine& { return threads == 1 ? *local : *leading; });
}

TEST(MpiSmallScenesLed, AreWhatBruteForceFinds) {
    lead_engines([](const EngineFor& engines) {
        const auto finding = check_small_cases(seeds(), engines);
        ASSERT_FALSE(finding) << finding->check << ": " << finding->text;
        if (!are_enough()) return;
        using enum Path;
        EXPECT_EQ(paths_not_taken({relay_full, relay_listed, relay_found_again, ranks_window}), "");
    });
}

void expect_found(Fault fault) {
    if (rank_count() == 1) GTEST_SKIP() << "no other rank";
    lead_engines([=](const EngineFor& engines) {
        const FaultScope planted(fault);
        const auto finding = check_small_cases({0, 300}, engines);
        ASSERT_TRUE(finding);
        std::printf("found by %s: %s\n", finding->check.c_str(), finding->text.c_str());
    });
}

TEST(MpiSmallScenesLed, FindsARankThatTakesItsNeighboursOctant) { expect_found(Fault::rank_takes_neighbour); }
TEST(MpiSmallScenesLed, FindsPairsThatAreNotSettled) { expect_found(Fault::postponed_pairs_kept); }
TEST(MpiSmallScenesLed, FindsPositionsThatAreSentInTooFewBits) { expect_found(Fault::positions_always_near); }

#endif

}  // namespace
}  // namespace octopair::test
