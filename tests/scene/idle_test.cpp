// Tests steps without a change: they find nothing, and cost nothing whatever the step before was.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"

namespace octopair::test {
namespace {

/// A scene with all objects of a sample.
class IdleScene : public ::testing::Test {
protected:
    IdleScene() { scene_.add(Objects{boxes_}, ids_); }

    void move_all(float way) {
        for (Box3f& box : boxes_) {
            box.min[0] += way;
            box.max[0] += way;
        }
        scene_.move(ids_, std::span<const Box3f>(boxes_));
    }
    /// Makes a step. Expects that it is not a full one, changes nothing and keeps the pairs.
    void expect_idle() {
        const auto before = scene_.pairs().to_vector();
        const StepResult& result = scene_.step();
        EXPECT_FALSE(result.full);
        EXPECT_TRUE(result.began.empty());
        EXPECT_TRUE(result.ended.empty());
        EXPECT_EQ(result.persisting, before.size());
        EXPECT_TRUE(scene_.pairs().to_vector() == before);
    }

    static constexpr std::size_t objects = 5000;
    std::vector<Box3f> boxes_ = samples::make_scene("uniform", objects, 1);
    std::vector<ObjectId> ids_ = std::vector<ObjectId>(objects);
    Scene scene_{SceneOptions{2}};
};

TEST_F(IdleScene, AfterAllObjectsMoved) {
    EXPECT_TRUE(scene_.step().full);
    expect_idle();
    move_all(0.25f);
    EXPECT_TRUE(scene_.step().full);
    for (int i = 0; i < 3; ++i) expect_idle();
}

TEST_F(IdleScene, WhenObjectsMoveToWhereTheyAre) {
    scene_.step();
    move_all(0.25f);
    scene_.step();
    move_all(0);
    expect_idle();
    scene_.move(std::span(ids_).first(50), std::span<const Box3f>(boxes_).first(50));
    expect_idle();
}

TEST_F(IdleScene, IsNotWhenOneObjectOfManyMoves) {
    scene_.step();
    move_all(0.25f);
    scene_.step();
    ASSERT_GT(scene_.pairs().size(), 0u);
    const Pair pair = scene_.pairs().to_vector().front();
    for (float& end : boxes_[pair.a].min) end = -1e6f;
    for (float& end : boxes_[pair.a].max) end = -1e6f;
    scene_.move(ids_, std::span<const Box3f>(boxes_));
    const StepResult& result = scene_.step();
    EXPECT_TRUE(std::ranges::find(result.ended, pair) != result.ended.end());
    EXPECT_TRUE(result.began.empty());
}

// An object that is moved to the box that bounds its sweep is no longer swept: after the step it stays there.
TEST_F(IdleScene, AfterASweepThatAMoveEnds) {
    scene_.step();
    const std::array<ObjectId, 1> one = {ids_[0]};
    const std::array<Box3f, 1> far = {{{{-1e6f, -1e6f, -1e6f}, {-1e6f, -1e6f, -1e6f}}}};
    scene_.sweep(one, std::span<const Box3f>(far));
    std::array<Box3f, 1> way = {boxes_[0]};
    for (float& end : way[0].min) end = -1e6f;
    scene_.move(one, std::span<const Box3f>(way));
    scene_.step();
    expect_idle();
}

TEST(Scene, AFirstStepWithoutObjectsIsIdleAfterwards) {
    Scene scene;
    scene.step();
    EXPECT_FALSE(scene.step().full);
}

}  // namespace
}  // namespace octopair::test
