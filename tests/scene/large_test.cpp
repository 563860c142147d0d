// Tests scenes large enough for deep octrees. Compares each step with a full detection by the engine, for any number of
// threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/test_hooks.hpp"
#include "octopair/octopair.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Returns the box around all boxes.
Box3f hull(std::span<const Box3f> boxes) {
    Box3f all = boxes.front();
    for (const Box3f& box : boxes) {
        for (int axis = 0; axis < 3; ++axis) {
            all.min[axis] = std::min(all.min[axis], box.min[axis]);
            all.max[axis] = std::max(all.max[axis], box.max[axis]);
        }
    }
    return all;
}

/// Forces the choice between full and incremental steps in builds with test hooks. In others, scenes choose by measured times.
class ForcedStep {
public:
#ifdef OCTOPAIR_TEST_HOOKS
    explicit ForcedStep(StepChoice choice) { test_hooks().tuning.scene.step = choice; }
    ~ForcedStep() { test_hooks().tuning.scene.step = default_tuning.scene.step; }
    ForcedStep(const ForcedStep&) = delete;
    ForcedStep& operator=(const ForcedStep&) = delete;
#else
    explicit ForcedStep(StepChoice) {}
#endif
};

class LargeScene : public ::testing::TestWithParam<std::string> {};

TEST_P(LargeScene, EveryStepIsWhatAFullDetectionFinds) {
    constexpr std::uint64_t objects = scaled(3000, 2);
    std::vector<Box3f> boxes = make_boxes(GetParam(), objects, 31);
    const std::vector<Box3f> places = make_boxes(GetParam(), objects, 32);
    std::vector<Scene> scenes;
    std::vector<ObjectId> ids(boxes.size());
    for (const unsigned threads : {1u, 2u, 3u}) {
        scenes.emplace_back(SceneOptions{threads});
        scenes.back().add(Objects{boxes}, ids);
    }
    std::mt19937 random(33);
    for (int step = 0; step < 7; ++step) {
        const ForcedStep forced(step % 2 == 1 ? StepChoice::incremental : StepChoice::full);
        const std::vector<Pair> expected = find_pairs(boxes);
        for (Scene& scene : scenes) {
            const bool full = scene.step().full;
            ASSERT_EQ(scene.pairs().to_vector(), expected) << "step " << step;
            if (has_test_hooks && step < 2) {
                EXPECT_EQ(full, step == 0) << "few objects move before step 1";
            }
        }
        // In other steps a twentieth of the objects move: half to new places, half onto another object, some twice.
        // Objects 0 and 1 grow over all boxes, or shrink.
        const std::size_t moving = step > 0 ? boxes.size() / 20 : 1;
        std::vector<ObjectId> moved;
        std::vector<Box3f> to;
        for (std::size_t i = 0; i < moving; ++i) {
            const std::size_t object = random() % boxes.size();
            boxes[object] = i % 2 == 0 ? places[random() % places.size()] : boxes[random() % boxes.size()];
            moved.push_back(ids[object]);
            to.push_back(boxes[object]);
        }
        for (const std::size_t object : {0u, 1u}) {
            boxes[object] = (step + object) % 2 == 0 ? hull(boxes) : places[object];
            moved.push_back(ids[object]);
            to.push_back(boxes[object]);
        }
        for (Scene& scene : scenes) scene.move(moved, std::span<const Box3f>(to));
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, LargeScene, ::testing::ValuesIn(all_kind_names()), param_name);

/// Tests the first object that is stored far above the leaves, in a step in which a small object moves.
TEST(LargeScene, ASmallOneThatMovesMeetsTheFirstGiant) {
    std::vector<Box3f> boxes = make_boxes("uniform", 4000, 34);
    std::vector<ObjectId> ids(boxes.size());
    Scene scene({1});
    scene.add(Objects{boxes}, ids);
    scene.step();
    const Box3f giant{{0, 0, 0}, {1, 1, 1}};
    boxes.push_back(giant);
    for (const std::size_t small : {7u, 8u}) {
        boxes[small].min[0] += 1e-3f;
        boxes[small].max[0] += 1e-3f;
        scene.move({&ids[small], 1}, std::span<const Box3f>(&boxes[small], 1));
    }
    ObjectId id;
    scene.add(Objects{std::span<const Box3f>(&giant, 1)}, {&id, 1});
    const ForcedStep forced(StepChoice::incremental);
    const bool full = scene.step().full;
    EXPECT_TRUE(!full || !has_test_hooks);  // without test hooks, a step that takes long becomes full
    EXPECT_EQ(scene.pairs().to_vector(), find_pairs(boxes));
}

/// Tests many objects that move out of the octree, where no octants divide them. The step costs more than estimated,
/// and its result stays right.
TEST(LargeScene, ManyThatLeaveTheOctreeAreFound) {
    std::vector<Box3f> boxes = make_boxes("uniform", scaled(30000, 4), 35);
    std::vector<ObjectId> ids(boxes.size());
    Scene scene({1});
    scene.add(Objects{boxes}, ids);
    scene.step();
    const std::size_t leaving = boxes.size() / 10;
    for (std::size_t i = 0; i < leaving; ++i) {
        const float place = 10 + 2 * float(i);
        boxes[i] = {{place, place, place}, {place + 2, place + 2, place + 2}};  // touches the next box
    }
    scene.move(std::span(ids).first(leaving), std::span<const Box3f>(boxes).first(leaving));
    scene.step();
    EXPECT_EQ(scene.pairs().to_vector(), find_pairs(boxes));
}

}  // namespace
}  // namespace octopair::test
