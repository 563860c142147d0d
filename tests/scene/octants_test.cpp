// Tests that a scene returns its boxes, and lists the octants of these boxes, after any calls.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

constexpr std::size_t scene_size = 9000;  // enough that octants are divided

template <typename Real>
bool same_box(const Box<Real>& a, const Box<Real>& b) {
    return std::ranges::equal(a.min, b.min) && std::ranges::equal(a.max, b.max);
}

template <typename Real>
Box<Real> union_of(Box<Real> a, const Box<Real>& b) {
    for (int axis = 0; axis < 3; ++axis) {
        a.min[axis] = std::min(a.min[axis], b.min[axis]);
        a.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return a;
}

/// Expected objects of a scene, by index.
template <typename Real>
struct Expected {
    struct Slot {
        bool exists = false;
        Box<Real> box = {};
        double padding = 0;
        ObjectId id = {};
    };
    std::vector<Slot> slots;
    double margin = 0;

    void expect_boxes(const Scene& scene) const {
        ASSERT_EQ(scene.indices(), slots.size());
        const Boxes variant = scene.boxes();
        ASSERT_TRUE(std::holds_alternative<std::span<const Box<Real>>>(variant));
        const auto boxes = std::get<std::span<const Box<Real>>>(variant);
        ASSERT_EQ(boxes.size(), slots.size());
        for (std::uint32_t index = 0; index < slots.size(); ++index) {
            ASSERT_EQ(scene.exists(index), slots[index].exists) << index;
            if (slots[index].exists) {
                ASSERT_TRUE(same_box(boxes[index], slots[index].box)) << index;
                ASSERT_EQ(scene.id(index), slots[index].id);
            }
        }
        ASSERT_FALSE(scene.exists(std::uint32_t(slots.size())));
        ASSERT_FALSE(scene.exists(~std::uint32_t(0)));
    }

    /// Compares the octants of the scene with those of its boxes alone.
    void expect_octants(const Scene& scene) const {
        std::vector<Box<Real>> boxes;
        std::vector<double> padding;
        std::vector<std::uint32_t> indices;
        for (std::uint32_t index = 0; index < slots.size(); ++index) {
            if (!slots[index].exists) continue;
            boxes.push_back(slots[index].box);
            padding.push_back(slots[index].padding);
            indices.push_back(index);
        }
        const bool padded = std::ranges::any_of(padding, [](double each) { return each > 0; });
        const Objects objects{boxes, padded ? padding : std::span<const double>()};
        const Octants alone = list_octants(objects, {margin}), all = scene.octants();
        ASSERT_EQ(all.all().size(), alone.all().size());
        std::vector<std::uint32_t> homes(slots.size(), Octants::no_octant);
        for (std::size_t i = 0; i < all.all().size(); ++i) {
            ASSERT_EQ(all.all()[i].code, alone.all()[i].code);
            ASSERT_TRUE(same_box(all.all()[i].bounds, alone.all()[i].bounds));
            ASSERT_EQ(all.all()[i].leaf, alone.all()[i].leaf);
            ASSERT_EQ(all.all()[i].homes, alone.all()[i].homes);
            ASSERT_TRUE(std::ranges::equal(all.objects(i), alone.objects(i), {}, {},
                                           [&](std::uint32_t position) { return indices[position]; }));
        }
        for (std::size_t i = 0; i < indices.size(); ++i) homes[indices[i]] = alone.home_octants()[i];
        ASSERT_TRUE(std::ranges::equal(all.home_octants(), homes));
        const std::vector<std::uint8_t> levels = all.levels();
        for (std::size_t index = 0; index < slots.size(); ++index) {
            ASSERT_EQ(levels[index] == Octants::no_level, !slots[index].exists);
        }
    }
    void expect(const Scene& scene) const {
        ASSERT_NO_FATAL_FAILURE(expect_boxes(scene));
        ASSERT_NO_FATAL_FAILURE(expect_octants(scene));
    }
};

/// Adds, moves and removes objects, and compares the scene after each call and each step.
template <typename Real>
void run(const SceneOptions& options, bool padded, std::vector<Box<Real>> boxes) {
    std::mt19937_64 random(4);
    Scene scene(options);
    Expected<Real> expected;
    expected.margin = options.margin;
    ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
    const auto view = [](const std::vector<Box<Real>>& all) { return std::span<const Box<Real>>(all); };
    const auto add = [&](std::size_t begin, std::size_t count) {
        const auto some = view(boxes).subspan(begin, count);
        const std::vector<double> padding(padded ? count : 0, 0.002);
        std::vector<ObjectId> ids(count);
        scene.add({some, padding}, ids);
        expected.slots.resize(std::size_t(scene.indices()));
        for (std::size_t i = 0; i < count; ++i) {
            expected.slots[ids[i].index] = {true, some[i], padded ? 0.002 : 0, ids[i]};
        }
    };
    const auto choose = [&](unsigned one_in) {
        std::vector<ObjectId> ids;
        for (const auto& slot : expected.slots) {
            if (slot.exists && random() % one_in == 0) ids.push_back(slot.id);
        }
        return ids;
    };
    const std::size_t most = boxes.size();
    add(0, most * 2 / 3);
    ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
    for (unsigned step = 0; step < 4; ++step) {
        const std::vector<ObjectId> moved = choose(3), swept = choose(5), removed = choose(7);
        std::vector<Box<Real>> places(moved.size());
        for (auto& place : places) place = boxes[random() % most];
        scene.move(moved, view(places));
        for (std::size_t i = 0; i < moved.size(); ++i) expected.slots[moved[i].index].box = places[i];
        places.resize(swept.size());
        for (auto& place : places) place = boxes[random() % most];
        scene.sweep(swept, view(places));
        for (std::size_t i = 0; i < swept.size(); ++i) {
            Box<Real>& box = expected.slots[swept[i].index].box;
            box = union_of(box, places[i]);
        }
        scene.remove(removed);
        for (const ObjectId id : removed) expected.slots[id.index].exists = false;
        ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
        scene.step();
        for (std::size_t i = 0; i < swept.size(); ++i) expected.slots[swept[i].index].box = places[i];
        ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
        add(most * 2 / 3, 100 + 300 * step);
        ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
    }
    scene.remove(choose(1));
    for (auto& slot : expected.slots) slot.exists = false;
    ASSERT_NO_FATAL_FAILURE(expected.expect(scene));
}

TEST(SceneOctants, EqualThoseOfTheBoxes) { run({}, false, make_boxes("uniform", scene_size, 1)); }

TEST(SceneOctants, EqualThoseOfTheBoxesInFloat64) {
    run({.precision = Precision::float64}, false, make_double_boxes("uniform", scene_size, 2));
}

TEST(SceneOctants, EqualThoseOfTheBoxesWithMarginAndPadding) {
    run({.threads = 3, .margin = 0.01}, true, make_boxes("clustered", scene_size, 3));
}

TEST(SceneOctants, EqualThoseOfTheBoxesWithSlack) { run({.slack = 0.05}, false, make_boxes("uniform", scene_size, 4)); }

TEST(SceneOctants, ChangeNoStep) {
    const std::vector<Box3f> boxes = make_boxes("uniform", 3000, 5);
    Scene scene, twin;
    for (Scene* each : {&scene, &twin}) {
        std::vector<ObjectId> ids(boxes.size());
        each->add({boxes}, ids);
        each->step();
        each->move(std::span(ids).first(1), std::span<const Box3f>(boxes).last(1));
        if (each == &scene) {
            EXPECT_EQ(each->octants().home_octants().size(), boxes.size());
        }
        each->step();
    }
    EXPECT_EQ(scene.pairs().to_vector(), twin.pairs().to_vector());
}

TEST(SceneOctants, AreCancelled) {
    Scene scene;
    std::vector<ObjectId> ids(1);
    scene.add({std::span<const Box3f>(make_boxes("uniform", 1, 6))}, ids);
    (void)error_of(ErrorCode::cancelled, [&] { scene.octants(requested_stop()); });
    EXPECT_EQ(scene.octants().all()[0].entries, 1u);
}

}  // namespace
}  // namespace octopair::test
