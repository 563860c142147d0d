// The parts of `octopair serve`: its options, the steps that are the same for all engines, and the supervisor.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "base/descriptor.hpp"
#include "cli/engine_choice.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/server.hpp"
#include "service/server/server_options.hpp"

namespace octopair::cli {

// serve_options.cpp

/// Options from the command line and from a configuration file.
struct ServeRequest {
    std::string config;  ///< path of a configuration file, or empty
    std::string listen, metrics;
    EngineChoice engine;
    std::optional<std::chrono::seconds> rank_silence;  ///< value of --rank-timeout, if given
    service::ServerOptions options;
    service::LogForm log_form = service::LogForm::text;
    std::string log_level = "info";
    bool quiet = false;
};

void add_serve_options(Command& command, ServeRequest& request);

/// Adds the options of the configuration file, and checks that the options fit together.
/// Requires: the command line was parsed.
/// Throws: Error{usage}; Error{io_failed} if the configuration file cannot be read.
void complete_serve_request(const Command& command, ServeRequest& request);

// serving.cpp

/// Returns how many jobs may run on threads of gRPC at a time: all threads but one, which reads the messages of other clients. gRPC 1.51
/// has half as many threads as cores, at least 2 and at most 16.
unsigned threads_for_instant_jobs();

/// Returns the options of the server, with the engine of the request. With --engine mpi, the caller must replace the engine.
service::ServerOptions server_options_of(const ServeRequest& request);

std::shared_ptr<spdlog::logger> make_log(const ServeRequest& request);

/// Logs that the server has started. `more` has additional fields for some engines.
void log_start(spdlog::logger& log, const service::Server& server, const service::ServerOptions& options,
               const std::vector<service::Field>& more = {});
#ifdef OCTOPAIR_WITH_MPI
/// Runs `octopair serve --engine mpi`: rank 0 answers clients, and all ranks find pairs. Collective.
/// Returns the exit status of this rank. Ends the program if a rank no longer responds.
int serve_on_ranks(const ServeRequest& request);
#endif
/// Raises the limit on open files of this process as far as the system allows. Lowers ServerLimits::connections to the number
/// of connections that this limit permits, and logs the change.
void fit_descriptors(service::ServerLimits& limits, spdlog::logger& log);

/// Lowers ServerLimits::memory_bytes to what fits into the memory of the machine and of the control group, and logs the change. A
/// limit of 0 (none) stays 0.
void fit_memory(service::ServerLimits& limits, spdlog::logger& log);

/// Blocks SIGHUP in this thread and those that it starts, for a Reloader. Call it before the first thread starts.
void block_hang_up();

/// Thread that calls Server::reload on each SIGHUP, and logs the result. Borrows the server and the log.
class Reloader {
public:
    Reloader(service::Server& server, spdlog::logger& log);
    Reloader(const Reloader&) = delete;
    Reloader& operator=(const Reloader&) = delete;
    ~Reloader();

private:
    std::atomic<bool> ends_ = false;
    std::thread thread_;
};

/// Waits for a stop request, and meanwhile calls `sometimes`, if given, every five seconds.
void wait_for_stop(const std::stop_token& stop, const std::function<void()>& sometimes = {});
/// Drains the server (Server::drain), and logs the beginning and the end.
void drain(spdlog::logger& log, service::Server& server);

// supervisor.cpp

/// Returns the listening socket that the supervisor passed to this process. Throws: Error{usage} if it did not pass exactly one.
Descriptor passed_socket();

/// The program that started the server and watches it, for example systemd (sd_notify(3), sd_listen_fds(3)). A build without libsystemd
/// sends no reports. A server that no program supervises has no supervisor, and sends no reports either.
class Supervisor {
public:
    /// Reports that the server is ready. If the supervisor asks for it, reports twice per interval that the server works, until this object
    /// is destroyed. Borrows the server.
    explicit Supervisor(const service::Server& server);
    Supervisor(const Supervisor&) = delete;
    Supervisor& operator=(const Supervisor&) = delete;
    ~Supervisor();

    /// Reports that the server takes no more jobs and ends.
    static void report_stopping();

private:
    std::jthread thread_;
};

}  // namespace octopair::cli
