// Options that select a server and the credentials for it. All subcommands that call a server share them.
#pragma once

#include <optional>
#include <string>

#include "octopair/client.hpp"

namespace octopair::cli {

class Command;

struct ServerChoice {
    std::string address;  ///< unix:PATH or HOST:PORT; empty if no server is selected
    ClientOptions options;
    std::string token_file;
    std::optional<double> patience;  ///< value of --patience in seconds, if given
};

/// Adds --token-file, --token-in-clear, --server-user, --tls, --tls-authority, --tls-certificate, --tls-key and --patience.
/// There is no option for the token itself, because other users can see the command line.
void add_server_options(Command& command, ServerChoice& choice);

/// Adds --server (default: the environment variable OCTOPAIR_SERVER) and the options of add_server_options().
void add_server_address(Command& command, ServerChoice& choice);

/// Throws: Error{usage} if no server is selected.
void check_server_named(const ServerChoice& choice);

/// Throws: Error{usage} if an option of add_server_options() is given but no server is selected.
void check_server_choice(const ServerChoice& choice);

/// Returns the options of `choice` with the token. The token comes from --token-file, else from OCTOPAIR_TOKEN.
/// Throws: Error if the file does not hold a token.
ClientOptions client_options(const ServerChoice& choice);

}  // namespace octopair::cli
