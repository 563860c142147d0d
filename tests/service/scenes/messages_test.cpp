// Tests scene messages that octopair's client never sends.
#include <gtest/gtest.h>

#include <random>

#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/scenes/raw_scene.hpp"
#include "service/scenes/scene_server.hpp"

namespace octopair::test {
namespace {

class SceneMessages : public ::testing::Test {
protected:
    std::string refusal_of(Bytes calls) {
        RawScene scene(server_.address());
        (void)scene.send(calls);
        const grpc::Status status = scene.end();
        EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
        return status.error_message();
    }

    /// Expects that the server still works.
    void expect_service() {
        RemoteScene scene = server_.scene();
        EXPECT_EQ(scene.step().pairs(), 0u);
    }

    SceneServer server_;
};

TEST_F(SceneMessages, BytesThatAreNoRecording) {
    const std::vector<std::byte> zeros(100);
    EXPECT_EQ(refusal_of(zeros), "scene: byte 0: not a recording of a scene");
    expect_service();
}

TEST_F(SceneMessages, RecordsThatAreDamaged) {
    Records records;
    records.boxes(3).step();
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
        std::vector<std::byte> bytes = records.bytes;
        bytes[random() % bytes.size()] ^= std::byte(1 << random() % 8);
        EXPECT_TRUE(refusal_of(bytes).starts_with("scene: byte "));
    }
    expect_service();
}

TEST_F(SceneMessages, ACallThatTheSceneRefuses) {
    Records records;
    records.remove(std::vector{ObjectId{3, 1}});
    EXPECT_EQ(refusal_of(records.bytes), "object 0 of the call: id 3.1 names no object of the scene");
    EXPECT_EQ(refusal_of(Records({.margin = -1}).step().bytes), "margin is -1.000000, not a finite number >= 0");
}

TEST_F(SceneMessages, ARecordThatIsTooLong) {
    Records records;
    records.boxes(100'000);
    EXPECT_EQ(refusal_of(records.bytes), "scene: byte 32: a record of more than 2097152 bytes; send smaller calls");
}

TEST_F(SceneMessages, PiecesOfAnyLength) {
    Records records;
    records.boxes(3).step().boxes(2).step();
    for (const std::size_t length : {1u, 7u, 50u}) {
        RawScene scene(server_.address());
        for (std::size_t at = 0; at < records.bytes.size(); at += length) {
            ASSERT_TRUE(scene.send(Bytes(records.bytes).subspan(at, std::min(length, records.bytes.size() - at))));
        }
        for (const std::uint64_t began : {3u, 7u}) {
            auto message = scene.receive();
            ASSERT_TRUE(message);
            v1::SceneDownload answer;
            std::size_t bytes = 0;
            ASSERT_TRUE(service::unpack(*message, answer, [&](Bytes piece) { bytes += piece.size(); }));
            EXPECT_EQ(answer.result().began(), began);
            EXPECT_EQ(bytes, began * sizeof(Pair));
        }
    }
}

}  // namespace
}  // namespace octopair::test
