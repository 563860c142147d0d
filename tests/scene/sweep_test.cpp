// Tests figure 2 of the paper: between two frames, a fast object moves from one side of another object to the far side.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"

namespace octopair::test {
namespace {

Box3f bullet_at(float x) { return {{x, 0.4f, 0.4f}, {x + 0.1f, 0.6f, 0.6f}}; }

class FastBullet : public ::testing::Test {
protected:
    FastBullet() {
        const std::vector<Box3f> boxes = {bullet_at(-3), {{0, 0, 0}, {0.2f, 1, 1}}};
        scene_.add(Objects{boxes}, ids_);
        EXPECT_EQ(scene_.step().pairs(), 0u);
    }

    std::span<const ObjectId> bullet() const { return std::span(ids_).first(1); }

    Scene scene_{{1}};
    std::vector<ObjectId> ids_ = std::vector<ObjectId>(2);
};

TEST_F(FastBullet, PassesThroughAWallWhereItIsMoved) {
    const Box3f far = bullet_at(3);
    scene_.move(bullet(), std::span(&far, 1));
    EXPECT_TRUE(scene_.step().began.empty());
}

TEST_F(FastBullet, HitsTheWallWhereItIsSwept) {
    const Box3f far = bullet_at(3);
    scene_.sweep(bullet(), std::span(&far, 1));
    const StepResult& through = scene_.step();
    ASSERT_EQ(through.began.size(), 1u);
    EXPECT_EQ(through.began[0], (Pair{0, 1}));
    // In the next step the bullet is beyond the wall, without a further call.
    const StepResult& beyond = scene_.step();
    EXPECT_TRUE(beyond.began.empty());
    EXPECT_EQ(beyond.ended.size(), 1u);
    // The next sweep begins at the bullet's present place.
    const Box3f further = bullet_at(6);
    scene_.sweep(bullet(), std::span(&further, 1));
    EXPECT_TRUE(scene_.step().began.empty());
}

TEST_F(FastBullet, IsNotSweptIfItIsMovedAfterAll) {
    const Box3f far = bullet_at(3), here = bullet_at(-4);
    scene_.sweep(bullet(), std::span(&far, 1));
    scene_.move(bullet(), std::span(&here, 1));
    EXPECT_TRUE(scene_.step().began.empty());
    EXPECT_TRUE(scene_.step().began.empty());
    scene_.sweep(bullet(), std::span(&far, 1));
    EXPECT_EQ(scene_.step().began.size(), 1u);
}

// After a step of sweeps, the boxes are no longer those that the step searched.
TEST(SweptObjects, AreFoundOnceByQueriesAfterTheStep) {
    auto boxes = samples::make_scene("uniform", 20'000, 1);
    std::vector<ObjectId> ids(boxes.size());
    Scene scene{{1}};
    scene.add(Objects{boxes}, ids);
    (void)scene.step();
    std::rotate(boxes.begin(), boxes.begin() + 1, boxes.end());  // each object goes to the place of another
    scene.sweep(std::span(ids).first(2'000), std::span<const Box3f>(boxes).first(2'000));
    scene.move(std::span(ids).subspan(2'000), std::span<const Box3f>(boxes).subspan(2'000));
    (void)scene.step();
    const Box3d world{{-1, -1, -1}, {2, 2, 2}};
    std::vector<std::uint32_t> all(boxes.size());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(scene.overlaps(world), all);
}

}  // namespace
}  // namespace octopair::test
