// Options of `octopair serve`, from the command line and from a configuration file.
#include <chrono>
#include <cstdint>
#include <memory>

#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "cli/server/serving.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

struct Described {
    const char* name;
    const char* type;
    const char* description;
};

/// Adds an option for a number. `Number` is an arithmetic type, or std::optional of it.
template <typename Number>
void add_number(Command& command, const Described& option, Number& value) {
    command
        .add_option(
            option.name, [option, &value](const std::string& text) { value = parse_count(option.name, text); },
            option.description)
        .type_name(option.type);
}

/// Adds an option for a number of bytes. `Bytes` is an integer type, or std::optional of it.
template <typename Bytes>
void add_bytes(Command& command, const Described& option, Bytes& value) {
    command
        .add_option(
            option.name, [option, &value](const std::string& text) { value = parse_bytes(option.name, text); },
            option.description)
        .type_name(option.type);
}

/// Adds an option for a whole number of seconds, at least `least`. `Seconds` is a duration, or an optional duration.
template <typename Seconds>
void add_seconds(Command& command, const Described& option, Seconds& value, unsigned least) {
    constexpr std::uint64_t most = 1'000'000'000;
    command
        .add_option(
            option.name,
            [option, least, &value](const std::string& text) {
                const std::uint64_t seconds = parse_count(option.name, text, most);
                if (seconds < least) throw Error(ErrorCode::usage, std::string(option.name) + ": at least 1 second");
                value = std::chrono::seconds(seconds);
            },
            option.description)
        .type_name(option.type);
}

void add_jobs(Command& command, service::ServerOptions& options) {
    command.begin_section("Jobs");
    command
        .add_option("--state", options.state_folder,
                    "folder for detached jobs, which survive the end of the server (default: no such jobs)")
        .type_name("DIR");
    add_seconds(command, {"--keep", "SECONDS", "how long results are kept that are not released (default 86400)"},
                options.keep, 1);
    add_seconds(command, {"--grace", "SECONDS", "time that running jobs get when the server stops (default 30)"},
                options.grace, 0);
    add_seconds(command,
                {"--stall", "SECONDS", "longest time that a client may take for its next message (default 60)"},
                options.stall, 1);
}

void add_rate_limits(Command& command, service::ServerLimits& limits) {
    add_number(command, {"--max-jobs", "N", "jobs and scenes at a time (default 1000)"}, limits.jobs);
    add_number(command, {"--max-jobs-per-client", "N", "jobs and scenes of one client at a time (default 200)"},
               limits.jobs_per_client);
    add_number(command, {"--max-connections", "N", "connections at a time (default 1000)"}, limits.connections);
    add_number(command,
               {"--max-connections-per-client", "N",
                "TCP connections of one client with a token or certificate (default: half of --max-connections)"},
               limits.connections_per_client);
    add_number(
        command,
        {"--max-calls-per-client", "N", "calls at a time of one client with a token or certificate (default 256)"},
        limits.calls_per_client);
    command
        .add_option(
            "--max-seconds",
            [&limits](const std::string& text) { limits.job_seconds = parse_length("--max-seconds", text); },
            "run time of a job (default 600)")
        .type_name("SECONDS");
}

void add_limits(Command& command, service::ServerLimits& limits) {
    command.begin_section("Limits");
    add_number(command,
               {"--max-objects", "N", "objects of a job or scene (default 50000000); for all limits, 0 means none"},
               limits.objects);
    add_bytes(command, {"--max-input", "BYTES", "size of a job's input (default 4G); K, M, G, T are powers of 1024"},
              limits.input_bytes);
    add_number(command, {"--max-pairs", "N", "stored pairs of a job (default 500000000)"}, limits.pairs);
    add_rate_limits(command, limits);
    add_bytes(command, {"--max-memory", "BYTES", "memory of all jobs together (default 8G)"}, limits.memory_bytes);
    add_bytes(command,
              {"--max-memory-per-client", "BYTES",
               "memory of one client with a token or certificate (default: half of --max-memory)"},
              limits.memory_bytes_per_client);
    add_bytes(command, {"--max-state", "BYTES", "disk space of all detached jobs together (default 16G)"},
              limits.state_bytes);
    add_bytes(command,
              {"--max-state-per-client", "BYTES",
               "disk space of one client with a token or certificate (default: half of --max-state)"},
              limits.state_bytes_per_client);
}

void add_access(Command& command, service::ServerOptions& options) {
    command.begin_section("Access");
    command.add_option("--tls-certificate", options.tls.certificate, "encrypt connections with this certificate")
        .type_name("FILE.pem");
    command.add_option("--tls-key", options.tls.key, "private key of the certificate").type_name("FILE.pem");
    command
        .add_option("--tls-client-authority", options.tls.client_authority,
                    "accept only clients with a certificate of this authority")
        .type_name("FILE.pem");
    command
        .add_option("--tokens", options.token_file,
                    "accept only clients with a token of this file, whose lines are NAME TOKEN")
        .type_name("FILE");
    command
        .add_option("--roles", options.role_file,
                    "file with lines CLIENT owner, reader OWNER, operator or none: other roles of clients")
        .type_name("FILE");
}

void add_watching(Command& command, ServeRequest& request) {
    command.begin_section("Log and metrics");
    command
        .add_option("--metrics", request.metrics, "serve metrics for Prometheus at this address, to this machine only")
        .type_name("HOST:PORT");
    command
        .add_option(
            "--log",
            [&request](const std::string& word) {
                check_value("--log", {"text", "json"}, word);
                request.log_form = word == "json" ? service::LogForm::json : service::LogForm::text;
            },
            "format of log lines on standard error: text (default) or json")
        .type_name("FORM");
    command
        .add_option(
            "--log-level",
            [&request](const std::string& word) {
                check_value("--log-level", {"debug", "info", "warn", "error"}, word);
                request.log_level = word;
            },
            "lowest level to log: debug, info (default), warn or error")
        .type_name("LEVEL");
    command.add_flag("--quiet", request.quiet, "log only errors");
}

}  // namespace

void add_serve_options(Command& command, ServeRequest& request) {
    command.begin_section("Address");
    command.add_option("--config", request.config, "read options from a file with lines NAME = VALUE (TOML)")
        .type_name("FILE");
    command
        .add_option("--listen", request.listen,
                    "address to listen on: unix:PATH, HOST:PORT, or systemd for the socket that it passes")
        .type_name("ADDRESS");
    add_engine_options(command, request.engine);
    command.find_option("--engine")->description("engine of the server: one of those that `octopair info` lists");
    add_seconds(
        command,
        {"--rank-timeout", "SECONDS", "longest time without a sign of life from a rank while a job runs (default 60)"},
        request.rank_silence, 1);
    add_jobs(command, request.options);
    add_limits(command, request.options.limits);
    add_access(command, request.options);
    add_watching(command, request);
}

void complete_serve_request(const Command& command, ServeRequest& request) {
    if (!request.config.empty()) apply_config(command, request.config);
    if (request.listen.empty()) throw Error(ErrorCode::usage, "serve: --listen is missing: unix:PATH or HOST:PORT");
    if (request.listen == "systemd") {
        request.options.listen_socket = std::make_shared<Descriptor>(passed_socket());
    } else {
        request.options.listen = service::parse_address(request.listen);
    }
    if (!request.metrics.empty()) request.options.metrics = service::parse_address(request.metrics);
    check_engine_choice(request.engine);
    if (request.engine.is_server()) {
        throw Error(ErrorCode::usage, "--engine: the engine of a server cannot be another server");
    }
    if (request.rank_silence && !request.engine.has_ranks()) {
        throw Error(ErrorCode::usage, "--rank-timeout: only --engine mpi has ranks");
    }
}

}  // namespace octopair::cli
