// Tests named cases that are known to break collision detectors, in both precisions.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baselines/baselines.hpp"
#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using Pairs = std::vector<Pair>;

/// Finds the pairs with 1, 2 and 8 threads in both orders. Fails if a result differs from the oracle's pairs. Returns
/// the oracle's pairs.
Pairs found_in(const Objects& objects, double margin = 0) {
    const Pairs expected = baselines::oracle_pairs(objects, margin);
    Options options{.margin = margin};
    for (const unsigned threads : {1u, 2u, 8u}) {
        for (const Order order : {Order::ascending, Order::octal}) {
            options.order = order;
            Pairs found = listed_pairs(*make_local_engine(threads), objects, options);
            if (order == Order::octal) found = baselines::ascending(std::move(found));
            EXPECT_TRUE(same_pairs(found, expected, {objects})) << threads << " threads, order " << int(order);
        }
    }
    return expected;
}

template <typename Real>
class Degenerate : public ::testing::Test {
protected:
    using Limits = std::numeric_limits<Real>;
    using Boxes = std::vector<Box<Real>>;

    static Box<Real> box(Real x, Real y, Real z, Real dx = 1, Real dy = 1, Real dz = 1) {
        return {{x, y, z}, {x + dx, y + dy, z + dz}};
    }
    static Box<Real> cube(Real low, Real high) { return {{low, low, low}, {high, high, high}}; }
    static Pairs found(const Boxes& boxes, double margin = 0) { return found_in(Objects{boxes}, margin); }
    static Boxes of_kind(const std::string& kind, std::uint64_t objects) {
        if constexpr (std::is_same_v<Real, float>) {
            return make_boxes(kind, objects, 1);
        } else {
            return make_double_boxes(kind, objects, 1);
        }
    }
};

using Precisions = ::testing::Types<float, double>;
struct PrecisionName {
    template <typename Real>
    static std::string GetName(int) {
        return sizeof(Real) == 4 ? "float32" : "float64";
    }
};
TYPED_TEST_SUITE(Degenerate, Precisions, PrecisionName);

TYPED_TEST(Degenerate, Empty) { EXPECT_TRUE(this->found({}).empty()); }

TYPED_TEST(Degenerate, One) { EXPECT_TRUE(this->found({this->box(1, 2, 3)}).empty()); }

TYPED_TEST(Degenerate, TwoTheSame) {
    EXPECT_EQ(this->found({this->box(1, 2, 3), this->box(1, 2, 3)}), (Pairs{{0, 1}}));
}

TYPED_TEST(Degenerate, Duplicates) {
    std::vector<Box<TypeParam>> boxes;
    for (int i = 0; i < 600; ++i) boxes.push_back(this->box(TypeParam(3 * (i % 3)), 0, 0));
    EXPECT_EQ(this->found(boxes).size(), 3u * 200 * 199 / 2);
}

TYPED_TEST(Degenerate, FacesTouch) {
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(1, 0, 0)}).size(), 1u);
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(0, 1, 0)}).size(), 1u);
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(0, 0, 1)}).size(), 1u);
}

TYPED_TEST(Degenerate, EdgesTouch) {
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(1, 1, 0)}).size(), 1u);
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(1, 0, -1)}).size(), 1u);
    EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(0, -1, 1)}).size(), 1u);
}

TYPED_TEST(Degenerate, CornersTouch) {
    for (const TypeParam x : {TypeParam(-1), TypeParam(1)}) {
        for (const TypeParam y : {TypeParam(-1), TypeParam(1)}) {
            for (const TypeParam z : {TypeParam(-1), TypeParam(1)}) {
                EXPECT_EQ(this->found({this->box(0, 0, 0), this->box(x, y, z)}).size(), 1u);
            }
        }
    }
}

TYPED_TEST(Degenerate, OneStepApart) {
    const TypeParam beyond = std::nextafter(TypeParam(1), TypeParam(2));
    EXPECT_TRUE(this->found({this->box(0, 0, 0), this->box(beyond, 0, 0)}).empty());
    EXPECT_TRUE(this->found({this->box(0, 0, 0), this->box(0, beyond, 0)}).empty());
    EXPECT_TRUE(this->found({this->box(0, 0, 0), this->box(0, 0, beyond)}).empty());
}

TYPED_TEST(Degenerate, GridOfTouchingCubes) {
    std::vector<Box<TypeParam>> boxes;
    for (int i = 0; i < 1000; ++i) {
        boxes.push_back(this->box(TypeParam(i % 10), TypeParam(i / 10 % 10), TypeParam(i / 100)));
    }
    // On each axis, 28 ordered pairs of 10 places are equal or adjacent. Without the 1,000 pairs of a cube with itself,
    // each pair is counted twice.
    EXPECT_EQ(this->found(boxes).size(), (28u * 28 * 28 - 1000) / 2);
}

TYPED_TEST(Degenerate, ZeroExtentOnOneAxis) {
    EXPECT_EQ(this->found({this->box(0, 0, 0, 0), this->box(0, 0, 0, 0)}).size(), 1u);
    EXPECT_EQ(this->found({this->box(0, 0, 0, 1, 0), this->box(0, 0, -1)}).size(), 1u);
    EXPECT_FALSE(this->found(this->of_kind("rectangles", 900)).empty());
}

TYPED_TEST(Degenerate, ZeroExtentOnTwoAxes) {
    EXPECT_EQ(this->found({this->box(0, 0, 0, 2, 0, 0), this->box(1, -1, 0, 0, 2, 0)}).size(), 1u);
    EXPECT_FALSE(this->found(this->of_kind("segments", 2000)).empty());
}

TYPED_TEST(Degenerate, ZeroExtentOnThreeAxes) {
    EXPECT_EQ(this->found({this->box(1, 1, 1, 0, 0, 0), this->box(1, 1, 1, 0, 0, 0)}).size(), 1u);
    EXPECT_FALSE(this->found(this->of_kind("points", 3000)).empty());
}

TYPED_TEST(Degenerate, AllPointsTheSame) {
    EXPECT_EQ(this->found(std::vector(500, this->box(7, 7, 7, 0, 0, 0))).size(), 500u * 499 / 2);
}

TYPED_TEST(Degenerate, PointsOnALine) {
    std::vector<Box<TypeParam>> boxes;
    for (int i = 0; i < 2000; ++i) boxes.push_back(this->box(0, TypeParam(i / 2), 0, 0, 0, 0));
    EXPECT_EQ(this->found(boxes).size(), 1000u);
}

TYPED_TEST(Degenerate, WorldSizeBoxes) { EXPECT_GT(this->found(this->of_kind("giants", 600)).size(), 100'000u); }

TYPED_TEST(Degenerate, WorldSizeBoxesAmongDust) { EXPECT_FALSE(this->found(this->of_kind("world10", 3000)).empty()); }

TYPED_TEST(Degenerate, OctantBorders) {
    EXPECT_FALSE(this->found(this->of_kind("borders", 2000)).empty());
    std::vector<Box<TypeParam>> boxes = {this->cube(0, 1)};
    for (int level = 0; level < 20; ++level) {
        const TypeParam border = std::ldexp(TypeParam(1), -level);
        boxes.push_back(this->cube(border, border));
        boxes.push_back(this->cube(std::nextafter(border, TypeParam(0)), std::nextafter(border, TypeParam(2))));
        boxes.push_back(this->cube(border / 2, border));
    }
    this->found(boxes);
}

TYPED_TEST(Degenerate, NegativeZero) {
    const TypeParam zero = 0, minus_zero = -zero;
    EXPECT_EQ(this->found({this->cube(-1, minus_zero), this->cube(zero, 1)}).size(), 1u);
    EXPECT_EQ(this->found({this->cube(-1, zero), this->cube(minus_zero, 1)}).size(), 1u);
    EXPECT_EQ(this->found({this->cube(minus_zero, zero), this->cube(zero, minus_zero)}).size(), 1u);
    this->found(this->of_kind("signed-zeros", 500));
}

TYPED_TEST(Degenerate, Denormals) {
    const TypeParam step = std::numeric_limits<TypeParam>::denorm_min();
    EXPECT_EQ(this->found({this->cube(0, step), this->cube(step, 2 * step)}).size(), 1u);
    EXPECT_TRUE(this->found({this->cube(0, step), this->cube(2 * step, 3 * step)}).empty());
    EXPECT_EQ(this->found({this->cube(0, step), this->cube(2 * step, 3 * step)}, double(step)).size(), 1u);
    EXPECT_TRUE(this->found({this->cube(-step, 0), this->cube(step, 1)}).empty());
    EXPECT_FALSE(this->found(this->of_kind("denormals", 1000)).empty());
}

TYPED_TEST(Degenerate, DenormalsInALargeWorld) {
    auto boxes = this->of_kind("denormals", 1000);
    boxes.push_back(this->cube(1e30f, 2e30f));
    EXPECT_FALSE(this->found(boxes).empty());
}

TYPED_TEST(Degenerate, LargestWorld) {
    const TypeParam max = std::numeric_limits<TypeParam>::max();
    EXPECT_EQ(this->found({this->cube(-max, max), this->cube(0, 0)}).size(), 1u);
    EXPECT_EQ(this->found({this->cube(-max, 0), this->cube(0, max)}).size(), 1u);
    EXPECT_TRUE(this->found({this->cube(-max, -max), this->cube(max, max)}).empty());
    EXPECT_FALSE(this->found(this->of_kind("largest", 2000)).empty());
}

TYPED_TEST(Degenerate, FarOrigin) { EXPECT_FALSE(this->found(this->of_kind("far-origin", 2000)).empty()); }

TYPED_TEST(Degenerate, SixDecadesOfSize) { EXPECT_FALSE(this->found(this->of_kind("decades", 3000)).empty()); }

TYPED_TEST(Degenerate, OneFarOut) {
    auto boxes = this->of_kind("uniform", 3000);
    boxes[1234] = this->cube(1e30f, 1e30f);
    EXPECT_FALSE(this->found(boxes).empty());
    boxes[77] = this->cube(-1e30f, 1e30f);
    EXPECT_GE(this->found(boxes).size(), 2999u);
}

TYPED_TEST(Degenerate, TwoWorlds) {
    auto boxes = this->of_kind("uniform", 3000);
    for (std::size_t i = 0; i < boxes.size(); i += 2) {
        for (int axis = 0; axis < 3; ++axis) {
            boxes[i].min[axis] = boxes[i].min[axis] / 1000 + 4096;
            boxes[i].max[axis] = boxes[i].max[axis] / 1000 + 4096;
        }
    }
    EXPECT_FALSE(this->found(boxes).empty());
}

TYPED_TEST(Degenerate, Staircase) {
    // Each box touches the next at a corner. The input is in descending order.
    std::vector<Box<TypeParam>> boxes;
    for (int i = 2000; i > 0; --i) boxes.push_back(this->cube(TypeParam(i), TypeParam(i + 1)));
    EXPECT_EQ(this->found(boxes).size(), 1999u);
}

TYPED_TEST(Degenerate, Nested) {
    std::vector<Box<TypeParam>> boxes;
    for (int i = 0; i < 600; ++i) boxes.push_back(this->cube(TypeParam(i), TypeParam(1200 - i)));
    EXPECT_EQ(this->found(boxes).size(), 600u * 599 / 2);
}

TYPED_TEST(Degenerate, MarginReachesToTheLastBit) {
    const double gap = 0x1p-10;
    const auto left = this->box(0, 0, 0), right = this->box(TypeParam(1 + gap), 0, 0);
    EXPECT_EQ(this->found({left, right}, gap).size(), 1u);
    EXPECT_TRUE(this->found({left, right}, std::nextafter(gap, 0)).empty());
}

TYPED_TEST(Degenerate, MarginBelowTheBoxesOwnSteps) {
    // At 1e7, the gap is a whole step of float32. Only a subtraction in float64 distinguishes the margins.
    const TypeParam far = 10'000'000;
    const auto left = this->box(far, far, far), right = this->box(far + 2, far, far);
    EXPECT_EQ(this->found({left, right}, 1).size(), 1u);
    EXPECT_TRUE(this->found({left, right}, std::nextafter(1.0, 0.0)).empty());
}

TYPED_TEST(Degenerate, EndlessMarginAndPadding) {
    const double huge = std::numeric_limits<double>::max();
    const auto boxes = this->of_kind("uniform", 100);
    EXPECT_EQ(this->found(boxes, huge).size(), 4950u);
    const std::vector<double> padding(100, huge);
    EXPECT_EQ(found_in({boxes, padding}, huge).size(), 4950u);
}

TYPED_TEST(Degenerate, OnePaddedObjectReachesAll) {
    const auto boxes = this->of_kind("uniform", 2000);
    std::vector<double> padding(2000, 0);
    padding[1000] = 10;
    EXPECT_GE(found_in({boxes, padding}).size(), 1999u);
}

TEST(DegenerateMixed, PrecisionsMeetInAJoin) {
    // 0.1 in float32 is greater than 0.1 in float64. Rounding to one precision would change the pairs.
    const std::vector<Box3f> floats = {{{0, 0, 0}, {0.1f, 1, 1}}, {{0.1f, 0, 0}, {1, 1, 1}}};
    const std::vector<Box3d> doubles = {{{0.1, 0, 0}, {0.2, 1, 1}}, {{0, 0, 0}, {0.1, 1, 1}}};
    const Objects first{floats}, second{doubles};
    EXPECT_EQ(listed_pairs(*make_local_engine(2), Join{first, second}), (Pairs{{0, 0}, {0, 1}, {1, 0}}));
}

TEST(DegenerateMixed, JoinWithAnEmptySet) {
    const auto boxes = make_boxes("uniform", 100, 1);
    const Objects some{boxes}, none{std::span<const Box3d>()};
    PairList list;
    const auto engine = make_local_engine(2);
    EXPECT_EQ(engine->find_pairs(Join{some, none}, list).pairs, 0u);
    EXPECT_EQ(engine->find_pairs(Join{none, some}, list).pairs, 0u);
    EXPECT_EQ(engine->count_pairs(Join{none, none}), 0u);
}

TEST(DegenerateMixed, JoinOfASetWithItself) {
    const auto boxes = make_boxes("dense", 500, 1);
    const Objects objects{boxes};
    const std::vector<Pair> list = listed_pairs(*make_local_engine(2), Join{objects, objects});
    EXPECT_TRUE(same_pairs(list, baselines::oracle_pairs_between(objects, objects), {objects, &objects}));
    EXPECT_EQ(list.size(), 2 * baselines::oracle_pairs(objects).size() + 500);
}

/// A few boxes on small whole numbers. RapidCheck shrinks failing cases.
RC_GTEST_PROP(DegenerateProperty, FewBoxesOnALattice, ()) {
    const auto ends = *rc::gen::container<std::vector<std::array<int, 6>>>(
        rc::gen::container<std::array<int, 6>>(rc::gen::inRange(0, 9)));
    std::vector<Box3f> boxes;
    for (const auto& e : ends) {
        Box3f box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = float(std::min(e[axis], e[axis + 3]));
            box.max[axis] = float(std::max(e[axis], e[axis + 3]));
        }
        boxes.push_back(box);
    }
    const Objects objects{boxes};
    const unsigned threads = *rc::gen::inRange(1u, 4u);
    RC_ASSERT(listed_pairs(*make_local_engine(threads), objects) == baselines::oracle_pairs(objects));
}

}  // namespace
}  // namespace octopair::test
