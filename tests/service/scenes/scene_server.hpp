// A server in the test's process, at its own socket. The test can stop and restart the server.
#pragma once

#include <grpc/grpc.h>
#include <spdlog/logger.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "octopair/octopair.hpp"
#include "octopair/remote_scene.hpp"
#include "service/server/server.hpp"

namespace octopair::test {

class SceneServer {
public:
    explicit SceneServer(const service::ServerLimits& limits = {},
                         std::chrono::seconds stall = std::chrono::seconds(60)) {
        // Without any user, gRPC ends its threads, which may take 10 s each time. So keep gRPC initialised.
        [[maybe_unused]] static const bool kept = (grpc_init(), true);
        static std::atomic<int> number = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("octopair-scenes-" + std::to_string(::getpid()) + "-" + std::to_string(++number));
        options_.listen = service::parse_address(address());
        options_.engine = [](unsigned width) { return make_local_engine(width); };
        options_.engine_name = "local";
        options_.limits = limits;
        options_.stall = stall;
        options_.grace = std::chrono::seconds(5);
        come();
    }
    SceneServer(const SceneServer&) = delete;
    SceneServer& operator=(const SceneServer&) = delete;
    ~SceneServer() {
        go();
        std::filesystem::remove(path_);
        std::filesystem::remove(path_.string() + ".lock");
    }

    std::string address() const { return "unix:" + path_.string(); }
    RemoteScene scene(const RemoteSceneOptions& options = {}) const { return connect_scene(address(), options, {}); }
    service::Server& server() { return *server_; }

    void come() { server_.emplace(options_, std::make_shared<spdlog::logger>("none")); }
    void go() { server_.reset(); }

private:
    std::filesystem::path path_;
    service::ServerOptions options_;
    std::optional<service::Server> server_;
};

/// Returns whether `holds` becomes true within a minute.
template <typename Condition>
bool comes_true(Condition&& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
        if (holds()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
}

}  // namespace octopair::test
