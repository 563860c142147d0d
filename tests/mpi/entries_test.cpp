// Tests that ranks which exchange entries in place of boxes find the pairs of the local engine, and send little if the objects of each rank
// are near each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "mpi/ranks.hpp"
#include "samples/scenes.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

std::vector<Box3f> uniform_boxes(std::size_t objects, std::uint64_t seed = 1) {
    return samples::make_scene("uniform", objects, seed);
}

/// Sorts boxes along an axis, so that slices are regions of space.
std::vector<Box3f> sorted_along(std::vector<Box3f> boxes, unsigned axis) {
    std::ranges::sort(boxes, {}, [axis](const Box3f& box) { return box.min[axis]; });
    return boxes;
}

/// Sorts boxes by the eighth of the unit cube that they begin in.
std::vector<Box3f> sorted_by_eighth(std::vector<Box3f> boxes) {
    const auto eighth = [](const Box3f& box) {
        return (box.min[2] < 0.5f ? 0 : 4) + (box.min[1] < 0.5f ? 0 : 2) + (box.min[0] < 0.5f ? 0 : 1);
    };
    std::ranges::stable_sort(boxes, {}, eighth);
    return boxes;
}

Case case_of(std::vector<Box3f> boxes) {
    Case whole;
    whole.first.boxes = std::move(boxes);
    return whole;
}

class RankEntries : public ::testing::Test {
protected:
    /// Expects the bytes of the local engine for all orders, and the same number of pairs.
    void expect_same(const Case& whole) {
        for (const Spread spread : spreads) {
            SCOPED_TRACE(name_of(spread));
            const Case own = slice(whole, spread);
            for (const Order order : {Order::ascending, Order::octal}) {
                const AnyCall asked{own, order, false, false}, alone{whole, order, false, false};
                EXPECT_TRUE(same_bytes(all_pieces(asked.made_by(*ranks_)), alone.made_by(*local_)));
                EXPECT_EQ(asked.counted_by(*ranks_), alone.counted_by(*local_));
            }
        }
    }
    /// Returns the number of bytes that all ranks send to count the pairs.
    std::uint64_t bytes_to_count(const std::vector<Box3f>& boxes) {
        const std::vector<Box3f> own = slice(boxes, Spread::even);
        (void)ranks_->count_pairs({own, {}});
        std::uint64_t bytes = last_costs(*ranks_).bytes_sent;
        MPI_Allreduce(MPI_IN_PLACE, &bytes, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
        return bytes;
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1), ranks_ = make_mpi_engine(MPI_COMM_WORLD);
};

TEST_F(RankEntries, OfRegionsGiveTheSameBytes) {
    for (const unsigned axis : {0u, 1u, 2u}) expect_same(case_of(sorted_along(uniform_boxes(scaled(40'000, 4)), axis)));
    expect_same(case_of(sorted_by_eighth(uniform_boxes(scaled(40'000, 4)))));
    Case joined = case_of(sorted_along(uniform_boxes(scaled(30'000, 4)), 1));
    joined.second.emplace().boxes = sorted_along(uniform_boxes(scaled(20'000, 4), 2), 1);
    joined.margin = 0.001;
    expect_same(joined);
}

TEST_F(RankEntries, StayInRegions) {
    if (rank_count() == 1) GTEST_SKIP() << "no other rank";
    const std::vector<Box3f> scattered = uniform_boxes(200'000);
    EXPECT_LT(bytes_to_count(sorted_by_eighth(scattered)), bytes_to_count(scattered) / 2);
}

/// Some boxes are so large that inner octants keep them.
TEST_F(RankEntries, OfInnerOctantsReachAllOctantsBelow) {
    std::vector<Box3f> boxes = uniform_boxes(scaled(40'000, 4));
    for (std::size_t i = 0; i < boxes.size(); i += 100) {
        for (unsigned axis = 0; axis < 3; ++axis) boxes[i].max[axis] += 0.1f;
    }
    expect_same(case_of(boxes));
    expect_same(case_of(sorted_along(boxes, 2)));
}

/// Boxes on a lattice touch their neighbours exactly, so cells decide no pair.
TEST_F(RankEntries, OfTouchingBoxesAreSettled) {
    std::vector<Box3f> boxes;
    const auto at = [](int i) { return float(i) * 0.1f; };
    for (int i = 0; i < 24 * 24 * 24; ++i) {
        const int x = i / (24 * 24), y = i / 24 % 24, z = i % 24;
        boxes.push_back({{at(x), at(y), at(z)}, {at(x + 1), at(y + 1), at(z + 1)}});
    }
    expect_same(case_of(boxes));
}

}  // namespace
}  // namespace octopair::test
