// Tests servers and clients that end during the life of a scene.
#include <gtest/gtest.h>

#include <thread>

#include "service/protocol/errors.hpp"
#include "service/scenes/scene_server.hpp"
#include "support/calls.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

constexpr Box3f elsewhere = {{5, 5, 5}, {6, 6, 6}};

const std::vector<Box3f> twice(2, Box3f{{0, 0, 0}, {1, 1, 1}});

/// Adds two objects that form a pair, without a step. Returns their ids.
std::vector<ObjectId> add_pair(RemoteScene& scene) {
    std::vector<ObjectId> ids(2);
    scene.add(Objects{twice}, ids);
    return ids;
}

TEST(RemoteSceneFaults, AStepWithoutAServerChangesNothingAndMayBeRepeated) {
    SceneServer server;
    RemoteScene scene = connect_scene(server.address(), {}, {.patience = std::chrono::milliseconds(100)});
    const std::vector<ObjectId> ids = add_pair(scene);
    (void)scene.step();
    server.go();
    scene.move(std::span(ids).first(1), std::span(&elsewhere, 1));
    (void)error_of(ErrorCode::engine_failed, [&] { (void)scene.step(); });
    EXPECT_EQ(scene.pairs().to_vector(), (std::vector<Pair>{{0, 1}}));
    server.come();
    const StepResult* step = nullptr;
    // With a patience of 100 ms, a step may fail again before the server answers.
    EXPECT_TRUE(comes_true([&] {
        try {
            step = &scene.step();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::engine_failed);
        }
        return step != nullptr;
    }));
    ASSERT_NE(step, nullptr);
    EXPECT_TRUE(step->full);
    EXPECT_TRUE(step->began.empty());
    ASSERT_EQ(step->ended.size(), 1u);
    EXPECT_EQ(step->persisting, 0u);
}

TEST(RemoteSceneFaults, AServerThatIsAwayForAWhileIsWaitedFor) {
    SceneServer server;
    RemoteScene scene = server.scene();
    (void)add_pair(scene);
    (void)scene.step();
    server.go();
    const std::jthread later([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        server.come();
    });
    EXPECT_EQ(scene.step().persisting, 1u);
}

TEST(RemoteSceneFaults, AServerThatGoesDownDoesNotWaitForIdleScenes) {
    SceneServer server;
    RemoteScene scene = server.scene();
    (void)add_pair(scene);
    (void)scene.step();
    server.server().drain();  // returns only after the scene's call has ended
    server.go();
    server.come();
    EXPECT_EQ(scene.step().persisting, 1u);
}

TEST(RemoteSceneFaults, AClientThatGoesAwayFreesItsScene) {
    SceneServer server({.jobs = 1});
    std::optional<RemoteScene> first = server.scene();
    RemoteScene second = server.scene();
    (void)add_pair(*first);
    (void)add_pair(second);
    (void)first->step();
    const auto steps = [&] {
        try {
            return second.step().pairs() == 1;
        } catch (const service::LimitError& error) {
            EXPECT_EQ(error.name(), "jobs");
            return false;
        }
    };
    EXPECT_FALSE(steps()) << "the server accepted two scenes, but its limit is one job";
    first.reset();
    EXPECT_TRUE(comes_true(steps));
}

TEST(RemoteSceneFaults, AStopBeforeAStepLeavesTheServersScene) {
    SceneServer server;
    RemoteScene scene = server.scene();
    (void)add_pair(scene);
    (void)scene.step();
    EXPECT_THROW((void)scene.step(requested_stop()), Error);
    EXPECT_FALSE(scene.step().full);
}

}  // namespace
}  // namespace octopair::test
