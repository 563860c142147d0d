#include "cli/server/server_choice.hpp"

#include <algorithm>
#include <cstdlib>

#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "octopair/error.hpp"
#include "service/protocol/credential_files.hpp"

namespace octopair::cli {

void add_server_options(Command& command, ServerChoice& choice) {
    command.begin_section("Server");
    command.add_option("--token-file", choice.token_file, "file with the token (default: the token in $OCTOPAIR_TOKEN)")
        .type_name("FILE");
    command.add_flag("--token-in-clear", choice.options.token_in_clear,
                     "send the token to a loopback address without encryption");
    command
        .add_option("--server-user", choice.options.server_user,
                    "user that runs the server at a Unix socket, if neither this user nor root")
        .type_name("USER");
    command.add_flag("--tls", choice.options.tls, "encrypt, and trust the system's certificate authorities");
    command.add_option("--tls-authority", choice.options.authority, "encrypt, and trust this certificate authority")
        .type_name("FILE.pem");
    command.add_option("--tls-certificate", choice.options.certificate, "certificate of this client")
        .type_name("FILE.pem");
    command.add_option("--tls-key", choice.options.key, "private key of the certificate").type_name("FILE.pem");
    command
        .add_option(
            "--patience", [&choice](const std::string& text) { choice.patience = parse_length("--patience", text); },
            "how long the server may be unreachable after its first answer (default 30)")
        .type_name("SECONDS");
}

void add_server_address(Command& command, ServerChoice& choice) {
    command.begin_section("Server");
    command
        .add_option("--server", choice.address,
                    "address of the server: unix:PATH or HOST:PORT (default: $OCTOPAIR_SERVER)")
        .environment("OCTOPAIR_SERVER")
        .type_name("ADDRESS");
    add_server_options(command, choice);
}

void check_server_named(const ServerChoice& choice) {
    if (choice.address.empty()) {
        throw Error(ErrorCode::usage, "no server is given; use --server ADDRESS, or set OCTOPAIR_SERVER");
    }
}

void check_server_choice(const ServerChoice& choice) {
    if (!choice.address.empty()) return;
    const ClientOptions& options = choice.options;
    const char* given = nullptr;
    if (!choice.token_file.empty()) given = "--token-file";
    if (options.token_in_clear) given = "--token-in-clear";
    if (!options.server_user.empty()) given = "--server-user";
    if (options.tls) given = "--tls";
    if (!options.authority.empty()) given = "--tls-authority";
    if (!options.certificate.empty()) given = "--tls-certificate";
    if (!options.key.empty()) given = "--tls-key";
    if (choice.patience) given = "--patience";
    if (given != nullptr) throw Error(ErrorCode::usage, std::string(given) + ": only with a server (--engine ADDRESS)");
}

ClientOptions client_options(const ServerChoice& choice) {
    constexpr double longest = 1e9;  // seconds; far from overflow in clock arithmetic
    // Errors of this program have the messages that gRPC would write to standard error.
    ::setenv("GRPC_VERBOSITY", "NONE", 0);
    ClientOptions options = choice.options;
    if (choice.patience)
        options.patience = std::chrono::milliseconds(std::int64_t(std::min(*choice.patience, longest) * 1e3));
    const char* const token = std::getenv("OCTOPAIR_TOKEN");
    if (!choice.token_file.empty())
        options.token = service::read_token(choice.token_file);
    else if (token != nullptr)
        options.token = token;
    return options;
}

}  // namespace octopair::cli
