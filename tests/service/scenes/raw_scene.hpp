// The call Scene with any bytes, message by message, without octopair's RemoteScene.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octopair/client.hpp"
#include "scene/recording/recording.hpp"
#include "service/client/connection.hpp"
#include "service/client/scene_stream.hpp"

namespace octopair::test {

/// Encodes calls as a recording in memory.
class Records final : public CallEncoder {
public:
    explicit Records(const SceneOptions& options = {}) { keep(bytes_of(recording_head(options))); }

    Records& boxes(std::size_t count) {
        const std::vector<Box3f> all(count, Box3f{{0, 0, 0}, {1, 1, 1}});
        add(Objects{all}, {});
        return *this;
    }
    Records& step() {
        append(RecordKind::step, {});
        return *this;
    }
    void append(RecordKind kind, std::initializer_list<Bytes> pieces) override {
        const auto [head, checksum] = envelope_of(kind, pieces);
        keep(bytes_of(head));
        for (const Bytes piece : pieces) keep(piece);
        keep(bytes_of(checksum));
    }

    std::vector<std::byte> bytes;

private:
    void keep(Bytes more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

class RawScene {
public:
    explicit RawScene(const std::string& address) : connection_(address, ClientOptions{}), stream_(connection_) {}

    /// Sends calls. Returns false if the server has ended the call.
    bool send(Bytes calls) {
        try {
            stream_.send(calls);
            return true;
        } catch (const service::SceneStream::Ended&) {
            return false;
        }
    }
    /// Waits for a message. Returns nothing if the server has ended the call.
    std::optional<grpc::ByteBuffer> receive() {
        try {
            return stream_.receive();
        } catch (const service::SceneStream::Ended&) {
            return {};
        }
    }
    /// Returns the status with which the server ends the call.
    grpc::Status end() {
        while (receive()) {
        }
        return stream_.status();
    }

private:
    service::Connection connection_;
    service::SceneStream stream_;
};

}  // namespace octopair::test
