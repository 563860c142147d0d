// Which server is asked, and with what: the options that all subcommands share which call one.
#pragma once

#include <optional>
#include <string>

#include "octopair/client.hpp"

namespace octopair::cli {

class Command;

struct ServerChoice {
    std::string address;  ///< unix:PATH or HOST:PORT; empty: none
    ClientOptions options;
    std::string token_file;
    std::optional<double> patience;  ///< in seconds
};

/// --token-file, --tls, --tls-authority, --tls-certificate, --tls-key, --patience. No token itself: others see the command
/// line.
void add_server_options(Command& command, ServerChoice& choice);

/// --server, which the environment may give (OCTOPAIR_SERVER), and those.
void add_server_address(Command& command, ServerChoice& choice);

/// Throws Error{usage} if no server was named.
void check_server_named(const ServerChoice& choice);

/// Throws Error{usage} for such options where no server is asked.
void check_server_choice(const ServerChoice& choice);

/// With the token of the file, or of the environment's OCTOPAIR_TOKEN. Throws Error if the file is not a token's.
ClientOptions client_options(const ServerChoice& choice);

}  // namespace octopair::cli
