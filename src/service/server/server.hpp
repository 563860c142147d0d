// Server: octopair's calls at an address.
#pragma once

#include <spdlog/fwd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "service/server/server_options.hpp"

namespace octopair::service {

/// What is on a server now.
struct ServerLoad {
    std::uint64_t jobs = 0;          ///< uploading, queued or running
    std::uint64_t memory_bytes = 0;  ///< of what ServerLimits::memory_bytes allows
    std::uint64_t connections = 0;   ///< those that were closed since are still counted for a while
};

class Server {
public:
    /// Listens and serves at once. Throws Error{usage} for an address that may not be served without protection,
    /// Error{io_failed} if the address is taken, and what the engine's maker throws.
    Server(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;
    /// At once: cancels what runs.
    ~Server();

    /// Where it listens, with the port that the system chose.
    const Address& address() const;
    /// Thread-safe.
    ServerLoad load() const;
    /// Takes no more jobs, waits for those that run, as long as `grace`, or else ServerOptions::grace, and cancels what is
    /// left.
    void drain(std::optional<std::chrono::milliseconds> grace = {});

private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair::service
