// Tests figure 2 of the paper: between two frames, a fast object moves from one side of another object to the far side.
#include <gtest/gtest.h>

#include "octopair/octopair.hpp"

namespace octopair::test {
namespace {

Box3f bullet_at(float x) { return {{x, 0.4f, 0.4f}, {x + 0.1f, 0.6f, 0.6f}}; }

class FastBullet : public ::testing::Test {
protected:
    FastBullet() {
        const std::vector<Box3f> boxes = {bullet_at(-3), {{0, 0, 0}, {0.2f, 1, 1}}};
        scene_.add(Objects{std::span<const Box3f>(boxes)}, ids_);
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

}  // namespace
}  // namespace octopair::test
