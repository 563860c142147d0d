// ServerOptions: address, engines, access and limits of a server.
// Start here to add a new limit of the server.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/descriptor.hpp"
#include "service/protocol/address.hpp"
#include "service/server/jobs/job_scheduler.hpp"

namespace octopair::service {

/// Limits of a server; 0: no limit. A refusal names the limit and its value.
struct ServerLimits {
    std::uint64_t objects = 50'000'000;                  ///< objects of a job or of a scene
    std::uint64_t input_bytes = std::uint64_t(4) << 30;  ///< bytes of the input of a job
    std::uint64_t pairs = 500'000'000;                   ///< stored pairs of a job or of a scene
    std::uint64_t jobs = 1000;  ///< jobs that are uploading, queued or running, and open scenes
    std::uint64_t jobs_per_client = 200;
    std::uint64_t connections = 1000;
    double job_seconds = 600;                             ///< run time of a job or of a step of a scene
    std::uint64_t memory_bytes = std::uint64_t(8) << 30;  ///< memory of all inputs, results and searches together
    std::uint64_t state_bytes = std::uint64_t(16) << 30;  ///< size of the state folder
    /// Parts of memory_bytes and state_bytes that one client may take. Default: half, on a server with tokens or client certificates;
    /// otherwise all.
    std::optional<std::uint64_t> memory_bytes_per_client = {}, state_bytes_per_client = {};
    /// Connections of one client over TCP. Default: half of `connections`, on a server with tokens or client certificates; otherwise all.
    std::optional<std::uint64_t> connections_per_client = {};
    /// Calls of one client at a time. Default: 256, on a server with tokens or client certificates; otherwise no limit.
    std::optional<std::uint64_t> calls_per_client = {};
};

/// Paths of PEM files. Without a certificate connections are not encrypted.
struct ServerTls {
    std::string certificate, key;
    std::string client_authority;  ///< clients must present a certificate of this authority; empty: any client
};

struct ServerOptions {
    Address listen;
    /// Listening socket that another program has passed to this process. The first server with these options uses the socket, and the
    /// socket's address replaces `listen`. Null: the server listens at `listen`.
    std::shared_ptr<Descriptor> listen_socket;
    EngineMaker engine;
    EngineMaker small_engine;        ///< maker of engines for small jobs; null: `engine`
    bool renewable_engines = false;  ///< engines are cheap to make: idle ones are made anew, which gives back memory
    std::string engine_name;         ///< value of the option --engine
    /// Returns how many workers of an engine were lost; null: the engines have no workers.
    std::function<std::uint64_t(const Engine&)> worker_faults;
    JobScheduler::Widths engine_widths;
    ServerLimits limits;
    ServerTls tls;
    std::string
        token_file;  ///< path of a file of tokens, one of which clients must send (token_file.hpp); empty: no tokens
    std::string role_file;           ///< path of a file of roles (role_file.hpp); empty: all clients are owners
    std::function<void()> on_drain;  ///< called when a client asks the server to end; null: such calls are refused
    std::string state_folder;        ///< path of the folder of detached jobs; empty: the server refuses such jobs
    std::chrono::seconds keep{24 * 3600};  ///< how long a running server keeps the result of a detached job
    std::chrono::seconds grace{30};        ///< how long a shutdown waits for running jobs
    std::optional<Address> metrics;        ///< address at which metrics are served over HTTP; empty: not served
    std::chrono::seconds stall{60};        ///< maximum time between two messages of a client, sent or read
};

/// Returns whether clients have different names (access.hpp).
inline bool tells_clients_apart(const ServerOptions& options) {
    return !options.token_file.empty() || !options.tls.client_authority.empty();
}

/// Returns how much of the amount `all` one client may take: `each` if given, else half if clients have different names, else 0 (no limit).
inline std::uint64_t share_of_client(const ServerOptions& options, std::uint64_t all,
                                     std::optional<std::uint64_t> each) {
    return each.value_or(tells_clients_apart(options) ? all - all / 2 : 0);
}

}  // namespace octopair::service
