// Tests that a remote scene refuses exactly the calls that a local scene refuses. The remote scene refuses at once,
// with the same message and without its server. Both scenes then work as before.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "service/scenes/scene_server.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

constexpr Box3f unit = {{0, 0, 0}, {1, 1, 1}};
constexpr Box3f far_away = {{5, 5, 5}, {6, 6, 6}};

Boxes boxes_of(const std::vector<Box3f>& boxes) { return std::span<const Box3f>(boxes); }

template <typename Call>
std::string refusal_of(Call&& call) {
    return error_of(ErrorCode::bad_input, call);
}

/// Makes equal calls to two scenes, each with two unit boxes at the same place.
class RemoteSceneErrors : public ::testing::Test {
protected:
    RemoteSceneErrors() {
        local_.add(Objects{boxes_of({unit, unit})}, ids_);
        remote_.add(Objects{boxes_of({unit, unit})}, ids_);
        (void)local_.step();
        (void)remote_.step();
    }

    template <typename Call>
    void expect_same_refusal(Call&& call) {
        const std::string words = refusal_of([&] { call(local_); });
        EXPECT_NE(words, "accepted");
        EXPECT_EQ(refusal_of([&] { call(remote_); }), words);
        const StepResult& step = remote_.step();
        EXPECT_TRUE(step.began.empty());
        EXPECT_TRUE(step.ended.empty());
        EXPECT_EQ(step.persisting, 1u);
        EXPECT_FALSE(step.full) << "the server built the scene again";
    }

    SceneServer server_;
    Scene local_;
    RemoteScene remote_ = server_.scene();
    std::vector<ObjectId> ids_ = std::vector<ObjectId>(2);
};

TEST_F(RemoteSceneErrors, IdsOfNoObject) {
    expect_same_refusal([&](auto& scene) {
        scene.move(std::vector{ids_[0], ObjectId{7, 1}}, boxes_of({far_away, unit}));
    });
    expect_same_refusal([](auto& scene) { scene.remove(std::vector{ObjectId{}}); });
    expect_same_refusal([](auto& scene) { scene.set_traits(std::vector{ObjectId{0, 3}}, std::vector<Traits>(1)); });
    expect_same_refusal([&](auto& scene) { scene.remove(std::vector{ids_[1], ids_[1]}); });
    expect_same_refusal([](auto& scene) { (void)scene.id(2); });
}

TEST_F(RemoteSceneErrors, RefusesInvalidBoxes) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<ObjectId> ids(2);
    expect_same_refusal([&](auto& scene) { scene.add(Objects{boxes_of({far_away, {{0, nan, 0}, {1, 1, 1}}})}, ids); });
    expect_same_refusal([&](auto& scene) { scene.move(ids_, boxes_of({far_away, {{2, 0, 0}, {1, 1, 1}}})); });
    expect_same_refusal([&](auto& scene) { scene.sweep(ids_, boxes_of({far_away})); });
    expect_same_refusal([&](auto& scene) {
        const std::vector<Box3d> wide(2);
        scene.move(ids_, std::span<const Box3d>(wide));
    });
}

TEST_F(RemoteSceneErrors, PaddingsAndTraits) {
    std::vector<ObjectId> ids(2);
    const std::vector<double> negative = {0, -1}, one = {1};
    expect_same_refusal([&](auto& scene) { scene.add(Objects{boxes_of({far_away, far_away}), negative}, ids); });
    expect_same_refusal([&](auto& scene) { scene.add(Objects{boxes_of({far_away, far_away}), one}, ids); });
    expect_same_refusal([&](auto& scene) {
        scene.add(Objects{boxes_of({far_away, far_away})}, ids, std::vector<Traits>(3));
    });
    expect_same_refusal([&](auto& scene) { scene.set_traits(ids_, std::vector<Traits>(3)); });
}

TEST_F(RemoteSceneErrors, Margins) {
    for (const double margin : {-1.0, double(NAN), double(INFINITY)}) {
        const std::string words = refusal_of([&] { (void)Scene({.margin = margin}); });
        EXPECT_EQ(refusal_of([&] { (void)server_.scene({.margin = margin}); }), words);
    }
}

TEST(RemoteSceneConnect, WhereNobodyListens) {
    (void)error_of(ErrorCode::engine_failed, [&] {
        (void)connect_scene("unix:/nowhere/at/all", {}, {.connect_timeout = std::chrono::milliseconds(50)});
    });
}

}  // namespace
}  // namespace octopair::test
