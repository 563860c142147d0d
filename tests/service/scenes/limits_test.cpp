// Tests the server's limits on a scene.
#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "service/protocol/errors.hpp"
#include "service/scenes/raw_scene.hpp"
#include "service/scenes/scene_server.hpp"

namespace octopair::test {
namespace {

std::vector<ObjectId> add_boxes(RemoteScene& scene, std::size_t count) {
    std::vector<Box3f> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back({{float(2 * i), 0, 0}, {float(2 * i + 1), 1, 1}});
    std::vector<ObjectId> ids(count);
    scene.add(Objects{boxes}, ids);
    return ids;
}

std::string limit_of(RemoteScene& scene) {
    try {
        (void)scene.step();
    } catch (const service::LimitError& error) {
        return error.name() + " " + std::to_string(error.allowed());
    }
    return "none";
}

TEST(RemoteSceneLimits, Objects) {
    SceneServer server({.objects = 100});
    RemoteScene scene = server.scene();
    std::vector<ObjectId> ids = add_boxes(scene, 100);
    EXPECT_EQ(limit_of(scene), "none");
    const std::vector<ObjectId> more = add_boxes(scene, 1);
    EXPECT_EQ(limit_of(scene), "objects 100");
    EXPECT_EQ(limit_of(scene), "objects 100");
    scene.remove(more);
    EXPECT_EQ(limit_of(scene), "objects 100") << "a removed object keeps its index until the next step";
}

TEST(RemoteSceneLimits, IndicesOfRemovedObjectsAreFreeAgain) {
    SceneServer server({.objects = 100});
    RemoteScene scene = server.scene();
    std::vector<ObjectId> ids = add_boxes(scene, 100);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(limit_of(scene), "none");
        scene.remove(ids);
        EXPECT_EQ(limit_of(scene), "none");
        ids = add_boxes(scene, 100);
    }
}

TEST(RemoteSceneLimits, Memory) {
    SceneServer server({.memory_bytes = 16'000'000});
    RemoteScene scene = server.scene(), other = server.scene();
    (void)add_boxes(scene, 100'000);
    EXPECT_EQ(limit_of(scene), "memory_bytes 16000000");
    (void)add_boxes(other, 50'000);
    EXPECT_TRUE(comes_true([&] { return limit_of(other) == "none"; })) << "the refused scene still has memory";
}

void add_crowd(RemoteScene& scene, std::size_t count) {
    const std::vector<Box3f> boxes(count, Box3f{{0, 0, 0}, {1, 1, 1}});
    std::vector<ObjectId> ids(boxes.size());
    scene.add(Objects{boxes}, ids);
}

TEST(RemoteSceneLimits, MemoryForPairs) {
    SceneServer server({.memory_bytes = 30'000'000});
    RemoteScene scene = server.scene();
    add_crowd(scene, 40'000);
    EXPECT_EQ(limit_of(scene), "memory_bytes 30000000") << "800 million pairs, 6.4 GB";
}

TEST(RemoteSceneLimits, Pairs) {
    SceneServer server({.pairs = 2000});
    RemoteScene scene = server.scene();
    add_crowd(scene, 63);
    EXPECT_EQ(limit_of(scene), "none") << "1,953 pairs";
    add_crowd(scene, 1);
    EXPECT_EQ(limit_of(scene), "pairs 2000") << "2,016 pairs";
}

TEST(RemoteSceneLimits, PlacesOfAClient) {
    SceneServer server({.jobs_per_client = 1});
    RemoteScene scene = server.scene(), other = server.scene();
    EXPECT_EQ(limit_of(scene), "none");
    EXPECT_EQ(limit_of(other), "jobs_per_client 1");
}

TEST(RemoteSceneLimits, AFrameThatStallsEnds) {
    SceneServer server({}, std::chrono::seconds(1));
    RawScene scene(server.address());
    Records records;
    records.boxes(10).step().boxes(1);
    ASSERT_TRUE(scene.send(records.bytes));
    const grpc::Status status = scene.end();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(status.error_message(), "stall_seconds: nothing was received for 1 s in the middle of a frame");
}

TEST(RemoteSceneLimits, ASceneMayBeIdleBetweenFrames) {
    SceneServer server({}, std::chrono::seconds(1));
    RemoteScene scene = server.scene();
    const std::vector<ObjectId> ids = add_boxes(scene, 10);
    (void)scene.step();
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    EXPECT_FALSE(scene.step().full);
}

TEST(RemoteSceneLimits, AClientThatDoesNotReadIsLeft) {
    SceneServer server({.jobs = 1}, std::chrono::seconds(1));
    RawScene scene(server.address());
    Records records;
    records.boxes(2000).step();  // 2 million pairs, 16 MB
    ASSERT_TRUE(scene.send(records.bytes));
    RemoteScene other = server.scene();
    EXPECT_TRUE(comes_true([&] { return limit_of(other) == "jobs 1"; })) << "the scene has not begun";
    EXPECT_TRUE(comes_true([&] { return limit_of(other) == "none"; }));
}

}  // namespace
}  // namespace octopair::test
