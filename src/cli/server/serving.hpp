// Steps of `octopair serve` that are the same for all engines: options, log, start and stop.
#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

#include "cli/server/serve_options.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/server.hpp"

namespace octopair::cli {

/// Returns how many jobs may run on threads of gRPC: all but one of these threads, so that one reads what other clients send. gRPC 1.51 has
/// half as many as cores, at least 2 and at most 16.
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

/// Lowers ServerLimits::memory_bytes to what fits into the memory of the machine and of the control group, and logs it. No limit stays
/// none.
void fit_memory(service::ServerLimits& limits, spdlog::logger& log);

/// Blocks SIGHUP in this thread and those that it starts, for a Reloader. Call it before the first thread starts.
void block_hang_up();

/// Calls Server::reload on each SIGHUP, and logs the result. Borrows the server and the log.
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

/// Waits for a stop request. Calls `sometimes`, if given, every five seconds.
void wait_for_stop(const std::stop_token& stop, const std::function<void()>& sometimes = {});
/// Drains the server (Server::drain), and logs the beginning and the end.
void drain(spdlog::logger& log, service::Server& server);

}  // namespace octopair::cli
