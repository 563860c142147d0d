// ServerOptions: address, engines, access and limits of a server.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/protocol/address.hpp"
#include "service/server/jobs/job_scheduler.hpp"

namespace octopair::service {

/// Limits of a server; 0: no limit. A refusal names the limit and its value.
struct ServerLimits {
    std::uint64_t objects = 50'000'000;                  ///< of a job or a scene
    std::uint64_t input_bytes = std::uint64_t(4) << 30;  ///< of a job
    std::uint64_t pairs = 500'000'000;                   ///< of the stored result of a job, and of a scene
    std::uint64_t jobs = 1000;  ///< jobs that are uploading, queued or running, and open scenes
    std::uint64_t jobs_per_client = 200;
    std::uint64_t connections = 1000;
    double job_seconds = 600;                             ///< run time of a job or of a step of a scene
    std::uint64_t memory_bytes = std::uint64_t(8) << 30;  ///< of all inputs, results and searches together
    std::uint64_t state_bytes = std::uint64_t(16) << 30;  ///< size of the state folder
    /// Parts of the two amounts above that one client may take. Default: half, on a server with tokens or client certificates; otherwise all.
    std::optional<std::uint64_t> memory_bytes_per_client = {}, state_bytes_per_client = {};
};

/// Paths of PEM files. Without a certificate connections are not encrypted.
struct ServerTls {
    std::string certificate, key;
    std::string client_authority;  ///< clients must present a certificate of this authority; empty: any client
};

struct ServerOptions {
    Address listen;
    EngineMaker engine;
    EngineMaker small_engine;  ///< maker of engines for small jobs; null: `engine`
    std::string engine_name;   ///< value of the option --engine
    /// Returns how many workers of an engine were lost; null: the engines have no workers.
    std::function<std::uint64_t(const Engine&)> worker_faults;
    JobScheduler::Widths engine_widths;
    ServerLimits limits;
    ServerTls tls;
    std::string token_file;    ///< lines "NAME TOKEN"; clients must send one of the tokens; empty: no tokens
    std::string state_folder;  ///< path of the folder of detached jobs; empty: the server refuses such jobs
    std::chrono::seconds keep{24 * 3600};  ///< how long a running server keeps the result of a detached job
    std::chrono::seconds grace{30};        ///< how long a shutdown waits for running jobs
    std::optional<Address> metrics;        ///< address at which metrics are served over HTTP; empty: not served
    std::chrono::seconds stall{60};        ///< maximum time between two messages of a client, sent or read
};

}  // namespace octopair::service
