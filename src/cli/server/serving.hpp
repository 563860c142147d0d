// Steps of `octopair serve` that are the same for all engines: options, log, start and stop.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <stop_token>
#include <vector>

#include "cli/server/serve_options.hpp"
#include "service/server/log/event.hpp"
#include "service/server/server.hpp"

namespace octopair::cli {

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
/// Waits for a stop request.
void wait_for_stop(const std::stop_token& stop);
/// Drains the server (Server::drain), and logs the beginning and the end.
void drain(spdlog::logger& log, service::Server& server);

}  // namespace octopair::cli
