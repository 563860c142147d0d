// What a scene refuses, and that it is the same afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "octopair/octopair.hpp"

namespace octopair {
namespace {

constexpr Box3f unit = {{0, 0, 0}, {1, 1, 1}};

Boxes boxes_of(const std::vector<Box3f>& boxes) { return std::span<const Box3f>(boxes); }

/// Two unit boxes at one place, of a step already made.
class SceneErrors : public ::testing::Test {
protected:
    SceneErrors() {
        scene_.add(Objects{boxes_of({unit, unit})}, ids_);
        (void)scene_.step();
    }

    template <typename Call>
    void expect_refused(Call&& call, const std::string& words) {
        try {
            call();
            FAIL() << "accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::bad_input);
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
        EXPECT_EQ(scene_.size(), 2u);
        const StepResult& step = scene_.step();
        EXPECT_TRUE(step.began.empty());
        EXPECT_TRUE(step.ended.empty());
        EXPECT_EQ(step.persisting, 1u);
    }

    Scene scene_;
    std::vector<ObjectId> ids_ = std::vector<ObjectId>(2);
};

TEST_F(SceneErrors, IdsThatAreNotOfTheScene) {
    expect_refused(
        [&] {
            scene_.move(std::vector{ids_[0], ObjectId{7, 1}}, boxes_of({{{9, 9, 9}, {9, 9, 9}}, unit}));
        },
        "object 1 of the call: id 7.1 is of no object");
    expect_refused([&] { scene_.remove(std::vector{ObjectId{}}); }, "is of no object");
    expect_refused([&] { scene_.set_traits(std::vector{ObjectId{0, 3}}, std::vector<Traits>(1)); }, "0.3");
}

TEST_F(SceneErrors, AnIdOfARemovedObjectIsNotThatOfItsSuccessor) {
    std::vector<ObjectId> third(1);
    scene_.add(Objects{boxes_of({{{5, 5, 5}, {6, 6, 6}}})}, third);
    scene_.remove(third);
    (void)scene_.step();
    std::vector<ObjectId> fourth(1);
    scene_.add(Objects{boxes_of({{{5, 5, 5}, {6, 6, 6}}})}, fourth);
    EXPECT_EQ(fourth[0].index, third[0].index);
    EXPECT_NE(fourth[0], third[0]);
    EXPECT_FALSE(scene_.contains(third[0]));
    EXPECT_EQ(scene_.id(fourth[0].index), fourth[0]);
    scene_.remove(fourth);
    expect_refused([&] { scene_.move(third, boxes_of({unit})); }, "is of no object");
}

TEST_F(SceneErrors, AnIndexIsNotGivenAgainBeforeTheNextStep) {
    scene_.remove(std::vector{ids_[1]});
    std::vector<ObjectId> third(1);
    scene_.add(Objects{boxes_of({unit})}, third);
    EXPECT_EQ(third[0].index, 2u);
    const StepResult& step = scene_.step();
    ASSERT_EQ(step.began.size(), 1u);
    EXPECT_EQ(step.began[0], (Pair{0, 2}));
    ASSERT_EQ(step.ended.size(), 1u);
    EXPECT_EQ(step.ended[0], (Pair{0, 1}));
}

TEST_F(SceneErrors, OneIdTwiceInARemoval) {
    expect_refused([&] { scene_.remove(std::vector{ids_[0], ids_[0]}); }, "twice");
}

TEST_F(SceneErrors, BoxesThatAreNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    for (const float wrong : {nan, infinity, 3.0f}) {
        const std::vector<Box3f> boxes = {unit, {{0, wrong, 0}, {1, 1, 1}}};
        expect_refused([&] { scene_.move(ids_, boxes_of(boxes)); }, "object 1 of the call");
        std::vector<ObjectId> ids(2);
        expect_refused([&] { scene_.add(Objects{boxes_of(boxes)}, ids); }, "object 1 of the call");
    }
}

TEST_F(SceneErrors, ArraysThatDoNotFit) {
    expect_refused([&] { scene_.move(ids_, boxes_of({unit})); }, "1 boxes for 2 ids");
    expect_refused([&] { scene_.set_traits(ids_, {}); }, "0 traits for 2 ids");
    const std::vector<double> paddings = {0};
    std::vector<ObjectId> ids(2);
    const std::vector<Box3f> two = {unit, unit};
    expect_refused([&] { scene_.add(Objects{boxes_of(two), paddings}, ids); }, "1 paddings for 2 objects");
    expect_refused([&] { scene_.add(Objects{boxes_of(two)}, ids, std::vector<Traits>(3)); }, "3 traits for 2 objects");
    const std::vector<double> negative = {0, -1};
    expect_refused([&] { scene_.add(Objects{boxes_of(two), negative}, ids); }, "padding");
}

TEST_F(SceneErrors, BoxesOfTheOtherPrecision) {
    const std::vector<Box3d> wide(2);
    expect_refused([&] { scene_.move(ids_, std::span<const Box3d>(wide)); }, "boxes are float64, the scene's float32");
}

TEST_F(SceneErrors, NoObjectAtAnIndex) {
    expect_refused([&] { (void)scene_.id(2); }, "no object has the index 2");
}

TEST(Scene, RefusesAMarginBelowZero) {
    EXPECT_THROW(Scene({1, Precision::float32, -1}), Error);
    EXPECT_THROW(Scene({1, Precision::float32, std::nan("")}), Error);
}

TEST(Scene, IsEmptyAtFirst) {
    Scene scene;
    const StepResult& step = scene.step();
    EXPECT_EQ(step.pairs(), 0u);
    EXPECT_EQ(scene.pairs().size(), 0u);
    EXPECT_EQ(scene.persisting().size(), 0u);
    EXPECT_EQ(scene.size(), 0u);
}

TEST(Scene, AStepThatWasStoppedCanBeRepeated) {
    Scene scene({1});
    std::vector<ObjectId> ids(2);
    scene.add(Objects{boxes_of({unit, {{5, 5, 5}, {6, 6, 6}}})}, ids);
    std::stop_source stopped;
    stopped.request_stop();
    EXPECT_THROW((void)scene.step(stopped.get_token()), Error);
    EXPECT_EQ(scene.step().pairs(), 0u);
    scene.move(std::vector{ids[1]}, boxes_of({unit}));
    EXPECT_THROW((void)scene.step(stopped.get_token()), Error);
    const StepResult& step = scene.step();
    ASSERT_EQ(step.began.size(), 1u);
    EXPECT_EQ(step.began[0], (Pair{0, 1}));
}

}  // namespace
}  // namespace octopair
