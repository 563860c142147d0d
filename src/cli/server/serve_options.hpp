// The options of `octopair serve`, on the command line and in a file.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "cli/engine_choice.hpp"
#include "service/server/log/event.hpp"
#include "service/server/server_options.hpp"

namespace octopair::cli {

struct ServeRequest {
    std::string config;  ///< a file, or empty
    std::string listen, metrics;
    EngineChoice engine;
    std::optional<std::chrono::seconds> rank_silence;  ///< as asked for
    service::ServerOptions options;
    service::LogForm log_form = service::LogForm::text;
    std::string log_level = "info";
    bool quiet = false;
};

void add_serve_options(Command& command, ServeRequest& request);

/// After parsing: takes the file in, and checks what belongs together. Throws Error{usage}.
void complete_serve_request(const Command& command, ServeRequest& request);

}  // namespace octopair::cli
