// What a server is told: where it listens, who may, and how much of everything it gives.
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

/// Each refusal says which of these it was, and how much it is. 0: none.
struct ServerLimits {
    std::uint64_t objects = 50'000'000;                  ///< of a job, or a scene
    std::uint64_t input_bytes = std::uint64_t(4) << 30;  ///< of a job
    std::uint64_t pairs = 500'000'000;                   ///< kept of a job's result
    std::uint64_t jobs = 1000;                           ///< uploading, queued or running; and scenes
    std::uint64_t jobs_per_client = 200;
    std::uint64_t connections = 1000;
    double job_seconds = 600;                             ///< from when it starts to run
    std::uint64_t memory_bytes = std::uint64_t(8) << 30;  ///< of all inputs, results and what finding pairs takes
    std::uint64_t state_bytes = std::uint64_t(16) << 30;  ///< of the state folder
};

/// PEM files; without a certificate connections are not encrypted.
struct ServerTls {
    std::string certificate, key;
    std::string client_authority;  ///< clients must have a certificate of this authority
};

struct ServerOptions {
    Address listen;
    EngineMaker engine;
    EngineMaker small_engine;  ///< of small jobs; null: `engine`
    std::string engine_name;   ///< as in --engine
    /// How many workers of an engine were lost; null: it has none.
    std::function<std::uint64_t(const Engine&)> worker_faults;
    JobScheduler::Widths engine_widths;
    ServerLimits limits;
    ServerTls tls;
    std::string token_file;                ///< lines "NAME TOKEN"; clients must have one of the tokens
    std::string state_folder;              ///< of detached jobs; empty: there are none
    std::chrono::seconds keep{24 * 3600};  ///< how long results of detached jobs wait, while the server runs
    std::chrono::seconds grace{30};        ///< for the jobs that run, when the server is asked to end
    std::optional<Address> metrics;        ///< where they are shown over HTTP; none: nowhere
    std::chrono::seconds stall{60};        ///< that a client may take for the next message, either way
};

}  // namespace octopair::service
