// Tests the octants of a search with brute force:
// - The octants are a whole octree in pre-order, and the bounds of children tile their parent.
// - Each object has its entries where its box is, and one home, which holds the low corner of the box.
// - The search of the engine has the same number of entries.
#include "octopair/octants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <random>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t scene_size = scaled(20000, 4);

/// Compares a list of octants with the boxes of its objects.
class OctantCheck {
public:
    OctantCheck(const Objects& objects, double margin, const Octants& octants)
        : objects_(objects), margin_(margin), octants_(octants), all_(octants.all()) {}

    void run() {
        ASSERT_NO_FATAL_FAILURE(check_tree());
        ASSERT_NO_FATAL_FAILURE(check_lists());
        for (std::uint32_t object = 0; object < objects_.size(); ++object) {
            ASSERT_NO_FATAL_FAILURE(check_object(object)) << "object " << object;
        }
    }

private:
    /// Checks one octant and the octants below it. Returns the next octant.
    std::size_t check_subtree(std::size_t octant, OctalCode code) {
        const OctantSummary& parent = all_[octant];
        EXPECT_EQ(parent.code, code) << code.text();
        next_.resize(all_.size());
        std::size_t next = octant + 1;
        if (!parent.leaf) {
            for (unsigned digit = 0; digit < 8; ++digit) {
                if (next >= all_.size()) {
                    ADD_FAILURE() << code.text() << " lacks children";
                    return next;
                }
                expect_child(parent.bounds, all_[octant + 1].bounds, all_[next].bounds, digit);
                next = check_subtree(next, code.child(digit));
            }
        }
        return next_[octant] = next;
    }
    /// `first`: the child with the digit 0, whose upper corner is the middle of the parent.
    void expect_child(const Box3d& parent, const Box3d& first, const Box3d& child, unsigned digit) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const bool upper = (digit >> axis & 1u) != 0;
            const double middle = first.max[axis];
            EXPECT_EQ(child.min[axis], upper ? middle : parent.min[axis]);
            EXPECT_EQ(child.max[axis], upper ? parent.max[axis] : middle);
            const double half = (parent.max[axis] - parent.min[axis]) / 2;
            const double largest = std::max(std::abs(all_[0].bounds.min[axis]), std::abs(all_[0].bounds.max[axis]));
            // Bounds are not halved where float32 ends.
            if (largest < double(FLT_MAX) / 2) {
                EXPECT_NEAR(middle, parent.min[axis] + half, largest * 0x1p-50);
            }
        }
    }
    void check_tree() {
        ASSERT_FALSE(all_.empty());
        ASSERT_EQ(check_subtree(0, {}), all_.size());
        ASSERT_FALSE(::testing::Test::HasFailure());
        for (unsigned axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(octants_.space().min[axis], all_[0].bounds.min[axis]);
            EXPECT_LE(octants_.space().max[axis], all_[0].bounds.max[axis]);
            EXPECT_LE(octants_.space().min[axis], octants_.space().max[axis]);
            EXPECT_TRUE(std::isfinite(all_[0].bounds.min[axis]) && std::isfinite(all_[0].bounds.max[axis]));
        }
    }

    void check_lists() {
        entries_.resize(std::size_t(objects_.size()));
        std::vector<std::uint32_t> homes(std::size_t(objects_.size()), Octants::no_octant);
        std::uint64_t entries = 0;
        for (std::uint32_t octant = 0; octant < all_.size(); ++octant) {
            const auto objects = octants_.objects(octant);
            ASSERT_EQ(objects.size(), all_[octant].entries);
            ASSERT_LE(all_[octant].homes, objects.size());
            for (unsigned axis = 0; axis < 3; ++axis) {
                const bool extended = all_[octant].bounds.min[axis] < all_[octant].bounds.max[axis];
                ASSERT_FALSE(extended && is_beyond(octant, axis) && !objects.empty()) << all_[octant].code.text();
            }
            const auto middle = objects.begin() + std::ptrdiff_t(all_[octant].homes);
            ASSERT_EQ(std::adjacent_find(objects.begin(), middle, std::greater_equal<>()), middle);
            ASSERT_EQ(std::adjacent_find(middle, objects.end(), std::greater_equal<>()), objects.end());
            for (const std::uint32_t object : objects) {
                ASSERT_LT(object, objects_.size());
                entries_[object].push_back(octant);
            }
            for (auto home = objects.begin(); home != middle; ++home) {
                ASSERT_EQ(homes[*home], Octants::no_octant);
                homes[*home] = octant;
            }
            entries += objects.size();
        }
        ASSERT_TRUE(std::ranges::equal(octants_.home_octants(), homes));
        const std::vector<std::uint8_t> levels = octants_.levels();
        ASSERT_EQ(levels.size(), objects_.size());
        for (std::size_t i = 0; i < levels.size(); ++i) ASSERT_EQ(levels[i], all_[homes[i]].code.level());
        Options options{.margin = margin_};
        ASSERT_EQ(make_local_engine(2)->stream_pairs(objects_, {}, options).entries, entries);
    }

    /// True if the object's box touches the octant, if both reach `reach` farther on each side.
    bool touches(const Box3d& box, std::size_t octant, double reach) const {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto [low, high] = interval(octant, axis);
            const double by = reach * tolerance(box, axis);
            if (reach < 0 && (is_beyond(octant, axis) || is_doubtful(box, axis))) return false;
            if (!(box.min[axis] <= high + by && box.max[axis] >= low - by)) return false;
        }
        return true;
    }
    /// Returns the coordinates that are looked up in an octant, infinite at the border of the space.
    std::pair<double, double> interval(std::size_t octant, unsigned axis) const {
        const double low = all_[octant].bounds.min[axis], high = all_[octant].bounds.max[axis];
        const Box3d space = octants_.space();
        return {low <= space.min[axis] ? -infinity : low, high >= space.max[axis] ? infinity : high};
    }
    bool is_beyond(std::size_t octant, unsigned axis) const {
        return octant != 0 && all_[octant].bounds.min[axis] >= octants_.space().max[axis];
    }
    /// True if the box reaches to where float32 ends. There bounds do not tell which octant has the entry.
    bool is_doubtful(const Box3d& box, unsigned axis) const {
        const Box3d root = all_[0].bounds;
        const bool vast = std::max(std::abs(root.min[axis]), std::abs(root.max[axis])) > double(FLT_MAX) / 4;
        return vast && box.max[axis] >= octants_.space().max[axis];
    }
    double tolerance(const Box3d& box, unsigned axis) const {
        const Box3d root = all_[0].bounds;
        const double largest = std::max({std::abs(box.min[axis]), std::abs(box.max[axis]), std::abs(root.min[axis])});
        return (root.max[axis] - root.min[axis]) * 0x1p-21 + largest * 0x1p-20;
    }
    Box3d widened_box(std::uint32_t object) const {
        const double by = margin_ / 2 + (objects_.padding.empty() ? 0 : objects_.padding[object]);
        return std::visit(
            [&](auto boxes) {
                Box3d box;
                for (int axis = 0; axis < 3; ++axis) {
                    box.min[axis] = double(boxes[object].min[axis]) - by;
                    box.max[axis] = double(boxes[object].max[axis]) + by;
                }
                return box;
            },
            objects_.boxes);
    }

    void check_object(std::uint32_t object) {
        const Box3d box = widened_box(object);
        const std::vector<std::uint32_t>& entries = entries_[object];
        ASSERT_GE(entries.size(), 1u);
        ASSERT_LE(entries.size(), 8u);
        for (const std::uint32_t octant : entries) ASSERT_TRUE(touches(box, octant, 1)) << all_[octant].code.text();
        for (unsigned axis = 0; axis < 3; ++axis) {
            const auto [low, high] = interval(octants_.home_octants()[object], axis);
            ASSERT_LE(box.min[axis], high + tolerance(box, axis));
            ASSERT_GE(box.min[axis], low - tolerance(box, axis));
        }
        bool covered = false;
        std::size_t end = 0;  // of the subtree of the last entry
        for (std::size_t octant = 0; octant < all_.size();) {
            if (octant >= end) covered = false;
            if (std::ranges::binary_search(entries, octant)) {
                ASSERT_FALSE(covered) << "entries in an octant and below it: " << all_[octant].code.text();
                covered = true;
                end = next_[octant];
            }
            const bool sure = touches(box, octant, -1);
            if (sure && all_[octant].leaf) {
                ASSERT_TRUE(covered) << "no entry in " << all_[octant].code.text();
            }
            octant = touches(box, octant, 1) ? octant + 1 : next_[octant];
        }
    }

    const Objects& objects_;
    double margin_;
    const Octants& octants_;
    std::span<const OctantSummary> all_;
    std::vector<std::size_t> next_;                    // by octant: first octant after its subtree
    std::vector<std::vector<std::uint32_t>> entries_;  // by object: octants with an entry, ascending
};

void expect_equal(const Octants& a, const Octants& b) {
    ASSERT_EQ(a.all().size(), b.all().size());
    for (std::size_t i = 0; i < a.all().size(); ++i) {
        ASSERT_EQ(a.all()[i].code, b.all()[i].code);
        ASSERT_TRUE(std::ranges::equal(a.all()[i].bounds.min, b.all()[i].bounds.min));
        ASSERT_TRUE(std::ranges::equal(a.objects(i), b.objects(i)));
    }
    ASSERT_TRUE(std::ranges::equal(a.home_octants(), b.home_octants()));
}

Octants check(const Objects& objects, double margin = 0) {
    Octants octants = list_octants(objects, {margin, 2});
    OctantCheck(objects, margin, octants).run();
    expect_equal(octants, list_octants(objects, {margin, 1}));
    expect_equal(octants, list_octants(objects, {margin, 5}));
    return octants;
}

template <typename Real>
Objects view(const std::vector<Box<Real>>& boxes) {
    return {boxes, {}};
}

class OctantsOfKind : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Kinds, OctantsOfKind, ::testing::ValuesIn(all_kind_names()), param_name);

TEST_P(OctantsOfKind, EqualBruteForce) { check(view(make_boxes(GetParam(), scene_size, 11))); }

TEST_P(OctantsOfKind, EqualBruteForceInFloat64) { check(view(make_double_boxes(GetParam(), scene_size, 12)), 0.001); }

TEST(Octants, OfFewObjects) {
    for (const std::size_t count : {0u, 1u, 2u, 7u}) {
        const std::vector<Box3f> boxes = make_boxes("uniform", count, 3);
        const Octants octants = check(view(boxes));
        EXPECT_EQ(octants.all().size(), 1u);
        EXPECT_EQ(octants.all()[0].homes, count);
        check(view(widened(boxes)), 0.5);
    }
}

TEST(Octants, WithPaddingAndMargin) {
    const std::vector<Box3f> boxes = make_boxes("uniform", scene_size, 5);
    std::mt19937_64 random(5);
    std::vector<double> padding(boxes.size());
    for (double& each : padding) each = std::uniform_real_distribution<>(0, 0.01)(random);
    const Octants octants = check(Objects{boxes, padding}, 0.01);
    EXPECT_GT(octants.all().size(), 8u);
}

TEST(Octants, FarFromTheOrigin) {
    std::vector<Box3d> boxes = make_double_boxes("uniform", scene_size, 6);
    for (Box3d& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) box.min[axis] += 1e6, box.max[axis] += 1e6;
    }
    EXPECT_GT(check(view(boxes)).all().size(), 8u);
}

TEST(Octants, HugeBoxAmongDust) {
    std::vector<Box3f> boxes = make_boxes("uniform", scene_size, 7);
    Box3f all = boxes[0];
    for (const Box3f& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            all.min[axis] = std::min(all.min[axis], box.min[axis]);
            all.max[axis] = std::max(all.max[axis], box.max[axis]);
        }
    }
    const std::uint32_t huge = 1234;
    boxes[huge] = all;
    const Octants octants = check(view(boxes));
    ASSERT_GT(octants.all().size(), 8u);
    const std::uint32_t home = octants.home_octants()[huge];
    EXPECT_FALSE(octants.all()[home].leaf);
    EXPECT_EQ(octants.objects(home)[0], huge);
    EXPECT_EQ(octants.levels()[huge], octants.all()[home].code.level());
}

TEST(Octants, AreValues) {
    const Octants none;
    EXPECT_TRUE(none.all().empty() && none.home_octants().empty() && none.levels().empty());
    EXPECT_EQ(none.space().max[0], 0);
    const std::vector<Box3f> boxes = make_boxes("uniform", 100, 8);
    Octants first = list_octants(view(boxes));
    const Octants second = first;
    const auto objects = second.objects(0);
    first = none;
    EXPECT_EQ(objects.size(), 100u);
    EXPECT_TRUE(first.all().empty());
}

TEST(Octants, NameInvalidInput) {
    for (const std::size_t count : {1u, 100u, 20000u}) {
        const std::size_t index = count * 2 / 3;
        std::vector<Box3f> boxes = make_boxes("uniform", count, 9);
        boxes[index].max[1] = std::numeric_limits<float>::quiet_NaN();
        expect_error(ErrorCode::bad_input, "object " + std::to_string(index), [&] {
            list_octants(view(boxes), {0, 3});
        });
    }
    const std::vector<Box3f> good = make_boxes("uniform", 100, 9);
    std::vector<double> padding(100, 0.5);
    padding[42] = -1;
    expect_error(ErrorCode::bad_input, "object 42", [&] { list_octants({good, padding}); });
    padding.resize(7);
    expect_error(ErrorCode::bad_input, "7 paddings", [&] { list_octants({good, padding}); });
    for (const double margin : {-1.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
        expect_error(ErrorCode::bad_input, "margin", [&] { list_octants(view(good), {margin}); });
    }
}

TEST(Octants, AreCancelled) {
    for (const std::size_t count : {0u, 1u, 20000u}) {
        const std::vector<Box3f> boxes = make_boxes("uniform", count, 10);
        expect_error(ErrorCode::cancelled, "cancelled", [&] { list_octants(view(boxes), {}, requested_stop()); });
    }
}

}  // namespace
}  // namespace octopair::test
