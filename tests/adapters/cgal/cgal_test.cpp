// Tests the adapter for CGAL against CGAL 5.5: the same calls, compiled with either header, find the same pairs.
//
// Boxes without extent on an axis are left out with the half-open topology, where the adapter differs (box_intersection_d.hpp).
//
// Replay: OCTOPAIR_TEST_SEED=<the seed that a failure printed>.
#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <random>

#include "adapters/cgal/calls.hpp"
#include "octopair/cgal/box_intersection_d.hpp"
#include "support/cases.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Random boxes of one kind. Coordinates are integers for most kinds, so that many boxes touch.
class RandomBoxes {
public:
    explicit RandomBoxes(std::uint64_t seed) : random_(seed), kind_(seed % 6), closed_(seed / 6 % 2 == 0) {}

    Question question() { return {boxes(below(200)), boxes(below(200)), closed_, std::ptrdiff_t(2 + below(20))}; }

private:
    std::size_t below(std::size_t end) { return std::size_t(random_() % end); }

    std::vector<Corners> boxes(std::size_t count) {
        std::vector<Corners> all(count);
        for (Corners& box : all) {
            for (int axis = 0; axis < 3; ++axis) set(box, axis);
        }
        return all;
    }

    void set(Corners& box, int axis) {
        double begin = 0, length = 0;
        switch (kind_) {
            case 0:  // cubes of a lattice, most of them touching others
                begin = double(below(5)), length = 1;
                break;
            case 1:  // lattice, some without extent
                begin = double(below(8)), length = double(below(3));
                break;
            case 2:  // long and thin
                begin = double(below(20)), length = double(below(3) == 0 ? 20 : below(2));
                break;
            case 3:  // nested
                length = double(2 * below(30)), begin = -length / 2;
                break;
            case 4:  // coincident, far from the origin
                begin = 1e6, length = double(below(2));
                break;
            default:  // not on a lattice
                begin = std::uniform_real_distribution<>(-10, 10)(random_);
                length = std::uniform_real_distribution<>(0.01, 5)(random_);
        }
        if (!closed_ && length == 0) length = 1;
        box.min[axis] = begin;
        box.max[axis] = begin + length;
        // Boxes of float and int have the same corners as those of double, except for the last kind.
        while (kind_ == 5 && !closed_ && int(box.min[axis]) == int(box.max[axis])) box.max[axis] += 1;
    }

    std::mt19937_64 random_;
    std::size_t kind_;
    bool closed_;
};

TEST(CgalAdapter, FindsThePairsOfCgal) {
    const auto of_cgal = with_cgal::calls(), of_octopair = with_octopair::calls();
    ASSERT_EQ(of_cgal.size(), of_octopair.size());
    const std::uint64_t seeds = case_count(scaled(1000, 20));
    std::size_t pairs = 0;
    for (std::uint64_t i = 0; i < seeds; ++i) {
        const std::uint64_t seed = case_seed("cgal", i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const Question question = RandomBoxes(seed).question();
        for (std::size_t call = 0; call < of_cgal.size(); ++call) {
            const Positions expected = of_cgal[call].answer(question);
            ASSERT_EQ(of_octopair[call].answer(question), expected) << of_cgal[call].name;
            pairs += expected.size();
        }
    }
    EXPECT_GT(pairs, 1000 * seeds);
}

namespace boxes = octopair::cgal::Box_intersection_d;

TEST(CgalAdapter, CallsBackWithTheRoundingOfTheCaller) {
    using Box = boxes::Box_d<double, 3>;
    const double lower[] = {0, 0, 0}, upper[] = {1, 1, 1};
    const std::vector<Box> two = {Box(lower, upper), Box(lower, upper)};  // with different ids
    ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
    double third = 0;
    int inside = 0;
    const volatile double one = 1, three = 3;
    cgal::box_self_intersection_d(two.begin(), two.end(), [&](const Box&, const Box&) {
        inside = std::fegetround();
        third = one / three;
    });
    const double expected = one / three;
    ASSERT_EQ(std::fesetround(FE_TONEAREST), 0);
    EXPECT_EQ(inside, FE_UPWARD);
    EXPECT_EQ(third, expected);
    EXPECT_GT(third, one / three);
}

TEST(CgalAdapter, NamesTheBoxThatIsNotANumber) {
    using Box = boxes::Box_d<double, 3>;
    const double lower[] = {0, 0, 0}, upper[] = {1, 1, 1}, wrong[] = {0, std::nan(""), 1};
    const std::vector<Box> all = {Box(upper, lower), Box(lower, upper), Box(lower, wrong)};
    expect_error(ErrorCode::bad_input, "box 2 ",
                 [&] { cgal::box_self_intersection_d(all.begin(), all.end(), [](const Box&, const Box&) {}); });
}

}  // namespace
}  // namespace octopair::test
