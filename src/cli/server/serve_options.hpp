// Options of `octopair serve`, from the command line and from a configuration file.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "cli/engine_choice.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/server_options.hpp"

namespace octopair::cli {

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

}  // namespace octopair::cli
