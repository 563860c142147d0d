// Tests frames of a million objects, whose calls and results need many messages.
#include <gtest/gtest.h>

#include "samples/scenes.hpp"
#include "service/scenes/scene_server.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

std::vector<Pair> list(std::span<const Pair> pairs) { return {pairs.begin(), pairs.end()}; }

TEST(RemoteSceneLarge, AFrameOfAMillionObjects) {
    const std::uint64_t count = scaled(1'000'000, 10);
    const std::vector<Box3f> boxes = samples::make_scene("uniform", count, 1);
    const std::vector<Box3f> moved = samples::make_scene("uniform", count, 2);
    SceneServer server;
    RemoteScene remote = server.scene();
    Scene local;
    std::vector<ObjectId> ids(boxes.size());
    local.add(Objects{boxes}, ids);
    remote.add(Objects{boxes}, ids);
    EXPECT_EQ(list(remote.step().began), list(local.step().began));

    local.move(ids, std::span(moved));
    remote.move(ids, std::span(moved));
    const StepResult &expected = local.step(), &found = remote.step();
    EXPECT_GT(expected.began.size(), std::size_t(count) / 4) << "the results would fit into few messages";
    EXPECT_EQ(list(found.began), list(expected.began));
    EXPECT_EQ(list(found.ended), list(expected.ended));
    EXPECT_EQ(found.persisting, expected.persisting);
    EXPECT_EQ(remote.pairs().to_vector(), local.pairs().to_vector());
}

}  // namespace
}  // namespace octopair::test
