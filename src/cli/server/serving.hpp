// What servers of this program have in common, whatever they look for pairs with: options, log, beginning and end.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <stop_token>
#include <vector>

#include "cli/server/serve_options.hpp"
#include "service/server/log/event.hpp"
#include "service/server/server.hpp"

namespace octopair::cli {

/// With the engine that was asked for, unless that is of ranks.
service::ServerOptions server_options_of(const ServeRequest& request);

std::shared_ptr<spdlog::logger> make_log(const ServeRequest& request);

/// `more`: what only some engines have to tell.
void tell_start(spdlog::logger& log, const service::Server& server, const service::ServerOptions& options,
                const std::vector<service::Field>& more = {});
/// Until there is a stop.
void wait_for(const std::stop_token& stop);
/// Tells that, too.
void drain(spdlog::logger& log, service::Server& server);

}  // namespace octopair::cli
