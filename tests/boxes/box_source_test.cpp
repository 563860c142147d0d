// Tests the input of boxes: every fault is found at every position, and rounding goes outward.
#include "boxes/box_source.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include "boxes/box_kernel.hpp"
#include "boxes/outward_rounding.hpp"

namespace octopair::test {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

TEST(BoxKernel, SeesEachFaultOfEachNumber) {
    const std::vector<Box3f> boxes(300, {{0, 1, 2}, {3, 1, 5}});
    std::vector<Entry> entries(boxes.size());
    ASSERT_TRUE(copy_boxes(boxes, entries));
    for (const std::size_t place : {std::size_t(0), std::size_t(7), boxes.size() - 1}) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            for (const float bad : {infinite, -infinite, nan, -nan, 100.0f}) {
                auto spoilt = boxes;
                spoilt[place].min[axis] = bad;
                EXPECT_FALSE(copy_boxes(spoilt, entries)) << bad;
                spoilt = boxes;
                spoilt[place].max[axis] = bad == 100.0f ? -bad : bad;
                EXPECT_FALSE(copy_boxes(spoilt, entries)) << bad;
            }
        }
    }
}

TEST(BoxKernel, AgreesWithItsSpecification) {
    const std::array<float, 10> values = {0, -0.0f, 1, -1, 1e-45f, FLT_MAX, -FLT_MAX, infinite, -infinite, nan};
    std::mt19937 random(1);
    std::array<std::size_t, 2> seen{};
    for (int i = 0; i < 20'000; ++i) {
        Box3f box{};
        for (unsigned axis = 0; axis < 3; ++axis) {
            box.min[axis] = values[random() % (i % 2 == 0 ? 7 : 10)];
            box.max[axis] = values[random() % (i % 2 == 0 ? 7 : 10)];
            if (i % 4 != 3 && box.min[axis] > box.max[axis]) std::swap(box.min[axis], box.max[axis]);
        }
        Entry entry;
        ASSERT_EQ(copy_boxes({&box, 1}, {&entry, 1}), is_box(box));
        ++seen[is_box(box) ? 1 : 0];
    }
    EXPECT_GT(seen[0], 1000u);
    EXPECT_GT(seen[1], 1000u);
}

/// Compares the kernel with the specification on boxes of special and of ordinary numbers. `Out`: Entry or Box3f.
template <typename Real, typename Out>
void check_rounding(const OutwardRounding& rounding, bool padded) {
    const Real most = std::numeric_limits<Real>::max();
    const Real special[] = {0,     Real(-0.0),   1, -1, Real(1e-45), Real(1e-40), Real(1 + 1e-7), most,
                            -most, Real(3.4e38), 7};
    std::mt19937_64 random(padded ? 3 : 4);
    std::uniform_real_distribution<double> place(-100, 100);
    std::vector<Box<Real>> boxes(3000);
    std::vector<double> padding(padded ? boxes.size() : 0);
    for (Box<Real>& box : boxes) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto number = [&] {
                return random() % 3 == 0 ? special[random() % std::size(special)] : Real(place(random));
            };
            std::tie(box.min[axis], box.max[axis]) = std::minmax({number(), number()});
        }
    }
    for (double& one : padding) one = random() % 20 == 0 ? DBL_MAX : random() % 2 == 0 ? 0 : std::abs(place(random));
    std::vector<Out> rounded(boxes.size());
    ASSERT_TRUE(round_boxes(boxes, padding, rounding, rounded));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Entry expected = rounding.entry(wide(boxes[i]), padded ? padding[i] : 0);
        ASSERT_EQ(std::memcmp(&rounded[i], &expected, 6 * sizeof(float)), 0) << i;
    }
    for (Real* const number :
         {&boxes[7].min[0], &boxes[7].min[1], &boxes[7].min[2], &boxes[7].max[0], &boxes[7].max[1], &boxes[7].max[2]}) {
        for (const Real wrong : {Real(nan), Real(infinite), -Real(infinite)}) {
            const Real right = std::exchange(*number, wrong);
            EXPECT_FALSE(round_boxes(boxes, padding, rounding, rounded)) << wrong;
            *number = right;
        }
    }
    boxes.back().max[1] = std::numeric_limits<Real>::infinity();
    EXPECT_FALSE(round_boxes(boxes, padding, rounding, rounded));
    boxes.back().max[1] = boxes.back().min[1];
    ASSERT_TRUE(round_boxes(boxes, padding, rounding, rounded));
    for (const double bad : {-1.0, double(nan), double(infinite)}) {
        if (!padded) break;
        padding[17] = bad;
        EXPECT_FALSE(round_boxes(boxes, padding, rounding, rounded)) << bad;
    }
    padding.assign(padding.size(), 0);
    std::swap(boxes[5].min[2], boxes[5].max[2]);
    boxes[5].min[2] += Real(1);
    EXPECT_FALSE(round_boxes(boxes, padding, rounding, rounded));
}

TEST(BoxKernel, RoundsAsSpecified) {
    for (const double margin : {0.0, 1e-9, 3.0, DBL_MAX}) {
        for (const double origin : {0.0, 12.345, -1e7}) {
            for (const bool padded : {false, true}) {
                const OutwardRounding rounding{{origin, -origin, 0, 0}, margin};
                check_rounding<float, Entry>(rounding, padded);
                check_rounding<float, Box3f>(rounding, padded);
                check_rounding<double, Entry>(rounding, padded);
                check_rounding<double, Box3f>(rounding, padded);
            }
        }
    }
}

Depths depths(const RoundingSlack& slack, const Entry& a, const Entry& b) {
    Depths depths;
    for (unsigned axis = 0; axis < 3; ++axis) {
        float largest = 0;
        for (const Entry& entry : {a, b}) {
            largest = std::max({largest, std::abs(entry.min[axis]), std::abs(entry.max[axis])});
        }
        depths[axis] = slack.depth(axis, largest);
    }
    return depths;
}

/// Checks that the entries of every pair overlap, and that objects whose entries overlap deeply are pairs.
void check_entries(std::span<const Box3d> boxes, double margin) {
    const Objects objects{boxes, {}};
    const BoxSource source(objects, nullptr, margin);
    std::vector<Entry> entries(boxes.size());
    ASSERT_TRUE(source.load(0, entries));
    std::size_t counted = 0;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        for (std::uint32_t k = 0; k < boxes.size(); ++k) {
            const bool counts = source.is_pair(i, k);
            counted += counts;
            ASSERT_TRUE(overlap(entries[i], entries[k]) || !counts) << i << " " << k;
            ASSERT_TRUE(counts || !deep(entries[i], entries[k], depths(source.slack(), entries[i], entries[k])))
                << i << " " << k;
        }
    }
    EXPECT_GT(counted, boxes.size());
}

TEST(BoxSource, EntriesHoldTheirBoxes) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-1, 1);
    for (const double scale : {1e-30, 1.0, 1e7, 1e30}) {
        std::vector<Box3d> boxes(500);
        for (Box3d& box : boxes) {
            for (unsigned axis = 0; axis < 3; ++axis) {
                box.min[axis] = (place(random) + 10) * scale;
                box.max[axis] = box.min[axis] + std::abs(place(random)) * scale;
            }
        }
        for (const double margin : {0.0, 1e-3 * scale}) check_entries(boxes, margin);
    }
}

/// Entries whose bounds are loaded again, in any order, are those that load() gives.
void expect_same_bounds(const BoxSource& source, std::mt19937& random) {
    std::vector<Entry> all(source.size());
    ASSERT_TRUE(source.load(0, all));
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < 3 * all.size(); ++i) {
        const Entry& entry = all[random() % all.size()];
        entries.push_back({{}, {}, entry.object, entry.mask});
    }
    source.load_bounds(entries);
    for (const Entry& entry : entries) ASSERT_EQ(std::memcmp(&entry, &all[entry.object], sizeof(Entry)), 0);
}

TEST(BoxSource, BoundsAreLoadedAgain) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-10, 10), length(0, 3);
    std::vector<Box3d> wide(200);
    std::vector<Box3f> narrow(wide.size());
    std::vector<double> padding(wide.size());
    for (std::size_t i = 0; i < wide.size(); ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            wide[i].min[axis] = place(random);
            wide[i].max[axis] = wide[i].min[axis] + length(random);
            narrow[i].min[axis] = float(wide[i].min[axis]);
            narrow[i].max[axis] = float(wide[i].max[axis]);
        }
        padding[i] = length(random);
    }
    const std::array<Objects, 4> sets = {Objects{narrow}, Objects{narrow, padding}, Objects{wide},
                                         Objects{wide, padding}};
    for (const double margin : {0.0, 0.1}) {
        for (const Objects& first : sets) {
            expect_same_bounds({first, nullptr, margin}, random);
            for (const Objects& second : sets) expect_same_bounds({first, &second, margin}, random);
        }
    }
}

TEST(BoxSource, EntriesHoldBoxesAtTheEndOfTheRange) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-DBL_MAX / 4, DBL_MAX / 4);
    std::vector<Box3d> boxes(300);
    for (Box3d& box : boxes) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto number = [&] {
                return random() % 3 == 0 ? std::copysign(DBL_MAX, place(random)) : place(random) * 4;
            };
            std::tie(box.min[axis], box.max[axis]) = std::minmax({number(), number()});
        }
    }
    for (const double margin : {0.0, 1e-300, 9.3e299, 1e307}) check_entries(boxes, margin);
}

}  // namespace
}  // namespace octopair::test
