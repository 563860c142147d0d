// Server: serves octopair's gRPC calls at an address.
#pragma once

#include <spdlog/fwd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "service/server/server_options.hpp"

namespace octopair::service {

/// Current load of a server.
struct ServerLoad {
    std::uint64_t jobs = 0;          ///< uploading, queued or running
    std::uint64_t memory_bytes = 0;  ///< reserved memory; limit: ServerLimits::memory_bytes
    std::uint64_t connections = 0;   ///< open connections; closed ones may still be counted for about a second
};

class Server {
public:
    /// Starts to serve. Throws: Error{usage} for an address that needs TLS and authentication which `options` lack;
    /// Error{io_failed} if the address is in use; what `ServerOptions::engine` throws.
    Server(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;
    /// Stops at once: cancels attached jobs, and leaves detached ones to the next server.
    ~Server();

    /// Returns the address with the actual port.
    const Address& address() const;
    /// Thread safety: any thread may call it.
    ServerLoad load() const;
    /// Returns how often the server has checked its deadlines: ten times a second while it works. Thread safety: any thread may call it.
    std::uint64_t beats() const;
    /// Reads the files of tokens, roles, keys and certificates again (Access::reload, Credentials::reload). Thread safety: one thread at
    /// a time. Throws: as the constructor, for these files; then the files of TLS, and the tokens with the roles, each stay or change
    /// together.
    void reload();
    /// Refuses new calls, waits for running jobs for at most `grace` (default: ServerOptions::grace), then cancels the rest.
    void drain(std::optional<std::chrono::milliseconds> grace = {});

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octopair::service
