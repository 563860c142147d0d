// Tests the calls that a scene refuses, and that a refused call leaves the scene unchanged.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include "octopair/octopair.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr Box3f unit = {{0, 0, 0}, {1, 1, 1}};

Boxes boxes_of(const std::vector<Box3f>& boxes) { return std::span<const Box3f>(boxes); }

/// Two unit boxes at the same place, after a step.
class SceneErrors : public ::testing::Test {
protected:
    SceneErrors() {
        scene_.add(Objects{boxes_of({unit, unit})}, ids_);
        (void)scene_.step();
    }

    template <typename Call>
    void expect_refused(Call&& call, const std::string& words) {
        expect_error(ErrorCode::bad_input, words, [&] { call(); });
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
        "object 1 of the call: id 7.1 names no object");
    expect_refused([&] { scene_.remove(std::vector{ObjectId{}}); }, "names no object");
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
    expect_refused([&] { scene_.move(third, boxes_of({unit})); }, "names no object");
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

TEST_F(SceneErrors, RefusesInvalidBoxes) {
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
    EXPECT_THROW((void)scene.step(requested_stop()), Error);
    EXPECT_EQ(scene.step().pairs(), 0u);
    scene.move(std::vector{ids[1]}, boxes_of({unit}));
    EXPECT_THROW((void)scene.step(requested_stop()), Error);
    const StepResult& step = scene.step();
    ASSERT_EQ(step.began.size(), 1u);
    EXPECT_EQ(step.began[0], (Pair{0, 1}));
}

/// A budget of bytes for SceneOptions::room_for_pairs. Throws: std::runtime_error if the budget is exhausted.
class Room {
public:
    explicit Room(std::uint64_t bytes) : left(bytes) {}
    void operator()(std::uint64_t bytes) {
        if (bytes > left) throw std::runtime_error("no room");
        left -= bytes;
        taken += bytes;
    }

    std::uint64_t left, taken = 0;
};

TEST(Scene, AStepThatHasNoRoomForItsPairsCanBeRepeated) {
    for (const unsigned threads : {1u, 3u}) {
        Room room(4'000'000);
        Scene scene({.threads = threads, .room_for_pairs = std::ref(room)});
        std::vector<ObjectId> few(100);
        scene.add(Objects{boxes_of(std::vector<Box3f>(few.size(), unit))}, few);
        EXPECT_EQ(scene.step().pairs(), 4950u);
        std::vector<ObjectId> many(3000);
        scene.add(Objects{boxes_of(std::vector<Box3f>(many.size(), unit))}, many);
        EXPECT_THROW((void)scene.step(), std::runtime_error);
        EXPECT_EQ(scene.pairs().size(), 4950u);
        EXPECT_GT(scene.pairs().chunks().size(), 0u);
        room.left = 400'000'000;
        const StepResult& step = scene.step();
        EXPECT_EQ(step.pairs(), 3100u * 3099 / 2);
        EXPECT_EQ(step.began.size(), 3100u * 3099 / 2 - 4950);
        EXPECT_GE(room.taken, 16 * step.pairs()) << "16 bytes per pair: in the list, and among those that began";
        EXPECT_LE(room.taken, 32 * step.pairs());
    }
}

TEST(Scene, ItsCallbackCannotCallIt) {
    unsigned refused = 0;
    Scene* scene = nullptr;
    SceneOptions options{.threads = 3};
    options.room_for_pairs = [&](std::uint64_t) {
        for (const auto& call :
             {std::function([&] { (void)scene->step(); }), std::function([&] { (void)scene->pairs(); }),
              std::function([&] { scene->remove({}); }), std::function([&] {
                  (void)scene->overlaps(Box3d{{0, 0, 0}, {1, 1, 1}});
              })}) {
            EXPECT_EQ(code_of(call), ErrorCode::usage);
            ++refused;
        }
        EXPECT_EQ(scene->size(), 100u);
    };
    Scene owner(options);
    scene = &owner;
    std::vector<ObjectId> ids(100);
    scene->add(Objects{boxes_of(std::vector<Box3f>(ids.size(), unit))}, ids);
    EXPECT_EQ(scene->step().pairs(), 4950u);
    EXPECT_GE(refused, 4u);
}

TEST(Scene, StepsThatHaveNoRoomLeaveWhatPersists) {
    Room room(100'000'000);
    Scene scene({.threads = 1, .room_for_pairs = std::ref(room)});
    std::vector<ObjectId> ids(700);
    scene.add(Objects{boxes_of(std::vector<Box3f>(ids.size(), unit))}, std::span(ids));
    (void)scene.step();
    scene.move(std::span(ids).first(1), boxes_of({{{5, 5, 5}, {6, 6, 6}}}));
    (void)scene.step();
    const std::uint64_t pairs = 699 * 698 / 2;
    std::vector<ObjectId> more(700);
    scene.add(Objects{boxes_of(std::vector<Box3f>(more.size(), unit))}, more);
    unsigned failed = 0;
    for (room.left = 0; failed < 100; room.left += 300'000, ++failed) {
        try {
            (void)scene.step();
            break;
        } catch (const std::runtime_error&) {
        }
        const std::uint64_t left = std::exchange(room.left, 100'000'000);
        EXPECT_EQ(scene.pairs().size(), pairs);
        EXPECT_EQ(scene.persisting().size(), pairs);
        room.left = left;
    }
    EXPECT_GE(failed, 10u);
    EXPECT_EQ(scene.pairs().size(), 1399u * 1398 / 2);
    EXPECT_EQ(scene.persisting().size(), pairs);
}

TEST(Scene, VeryManyPairsBeginWhereLittleMoves) {
    const std::size_t apart = scaled(200'000, 4), together = 1700;
    std::vector<Box3f> boxes(apart);
    for (std::size_t i = 0; i < apart; ++i) boxes[i].min[i % 3] = boxes[i].max[i % 3] = float(i + 1);
    Scene scene({2});
    std::vector<ObjectId> ids(apart);
    scene.add(Objects{boxes_of(boxes)}, ids);
    EXPECT_EQ(scene.step().pairs(), 0u);
    scene.move(std::span(ids).first(10), boxes_of(std::vector<Box3f>(10, unit)));
    EXPECT_EQ(scene.step().pairs(), 45u);
    scene.move(std::span(ids).first(together), boxes_of(std::vector<Box3f>(together, unit)));
    const StepResult& step = scene.step();
    EXPECT_EQ(step.began.size(), together * (together - 1) / 2 - 45);
    EXPECT_EQ(scene.pairs().size(), together * (together - 1) / 2);
}

TEST(Scene, ErrorsHaveTheirPlaces) {
    Scene scene;
    std::vector<ObjectId> ids(3);
    scene.add(Objects{boxes_of({unit, unit, unit})}, ids);
    const Box3f bad = {{0, 0, 0}, {-1, 1, 1}};
    expect_place([&] { scene.move(ids, boxes_of({unit, unit, bad})); }, 2, 0);
    Answers<std::uint32_t> answers;
    const std::vector<Sphere> spheres = {{{0, 0, 0}, 1}, {{0, 0, 0}, -1}};
    expect_place([&] { scene.overlaps(spheres, answers); }, 1, 0);
    EXPECT_FALSE(place_of_error([&] { scene.move(ids, boxes_of({unit})); }));
}

}  // namespace
}  // namespace octopair::test
