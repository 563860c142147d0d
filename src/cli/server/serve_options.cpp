#include "cli/server/serve_options.hpp"

#include <chrono>
#include <cstdint>

#include "cli/command/command.hpp"
#include "cli/command/config_file.hpp"
#include "cli/command/numbers.hpp"
#include "cli/command/words.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

struct Described {
    const char* name;
    const char* type;
    const char* description;
};

void add_number(Command& command, const Described& option, std::uint64_t& value) {
    command
        .add_option(
            option.name, [option, &value](const std::string& text) { value = parse_count(option.name, text); },
            option.description)
        .type_name(option.type);
}

void add_bytes(Command& command, const Described& option, std::uint64_t& value) {
    command
        .add_option(
            option.name, [option, &value](const std::string& text) { value = parse_bytes(option.name, text); },
            option.description)
        .type_name(option.type);
}

/// Whole, at least `least`. `Seconds`: some, or perhaps some.
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

void add_limits(Command& command, service::ServerLimits& limits) {
    add_number(command, {"--max-objects", "N", "objects of a job or a scene (default 50000000; 0: no limit, as below)"},
               limits.objects);
    add_bytes(command, {"--max-input", "BYTES", "bytes of a job's input; K, M, G, T count by 1024 (default 4G)"},
              limits.input_bytes);
    add_number(command, {"--max-pairs", "N", "pairs kept of a job's result (default 500000000)"}, limits.pairs);
    add_number(command, {"--max-jobs", "N", "jobs and scenes at a time (default 1000)"}, limits.jobs);
    add_number(command, {"--max-jobs-per-client", "N", "of these, of one client (default 200)"},
               limits.jobs_per_client);
    add_number(command, {"--max-connections", "N", "connections at a time (default 1000)"}, limits.connections);
    command
        .add_option(
            "--max-seconds",
            [&limits](const std::string& text) { limits.job_seconds = parse_length("--max-seconds", text); },
            "that a job may run (default 600)")
        .type_name("SECONDS");
    add_bytes(command, {"--max-memory", "BYTES", "memory of all jobs together (default 8G)"}, limits.memory_bytes);
    add_bytes(command, {"--max-state", "BYTES", "disk of all detached jobs together (default 16G)"},
              limits.state_bytes);
}

void add_state(Command& command, service::ServerOptions& options) {
    command
        .add_option("--state", options.state_folder,
                    "a folder for detached jobs, which outlive the server (default: there are none)")
        .type_name("DIR")
        .check([](const std::string& folder) { return folder.empty() ? "a folder is wanted" : ""; });
    add_seconds(command, {"--keep", "SECONDS", "that results of detached jobs wait to be released (default 86400)"},
                options.keep, 1);
}

void add_access(Command& command, service::ServerOptions& options) {
    command.add_option("--tls-certificate", options.tls.certificate, "encrypt, with this certificate")
        .type_name("FILE.pem");
    command.add_option("--tls-key", options.tls.key, "the key of the certificate").type_name("FILE.pem");
    command
        .add_option("--tls-client-authority", options.tls.client_authority,
                    "clients must have a certificate of this authority")
        .type_name("FILE.pem");
    command.add_option("--tokens", options.token_file, "clients must have one of these tokens: lines NAME TOKEN")
        .type_name("FILE");
}

void add_watching(Command& command, ServeRequest& request) {
    command.add_option("--metrics", request.metrics, "show metrics for Prometheus there, on this machine alone")
        .type_name("HOST:PORT");
    command
        .add_option(
            "--log",
            [&request](const std::string& word) {
                check_word({"--log", {"text", "json"}, {}}, word);
                request.log_form = word == "json" ? service::LogForm::json : service::LogForm::text;
            },
            "form of the log's lines on standard error: text (default) or json")
        .type_name("FORM");
    command
        .add_option(
            "--log-level",
            [&request](const std::string& word) {
                check_word({"--log-level", {"debug", "info", "warn", "error"}, {}}, word);
                request.log_level = word;
            },
            "what is logged: debug, info (default), warn or error")
        .type_name("LEVEL");
    command.add_flag("--quiet", request.quiet, "log errors alone");
}

}  // namespace

void add_serve_options(Command& command, ServeRequest& request) {
    command.add_option("--config", request.config, "options from a file, as lines NAME = VALUE (TOML)")
        .type_name("FILE");
    command.add_option("--listen", request.listen, "unix:PATH or HOST:PORT").type_name("ADDRESS");
    add_engine_options(command, request.engine);
    command.find_option("--engine")->description("where the server looks for pairs: as in `octopair info`, itself");
    add_seconds(command,
                {"--rank-timeout", "SECONDS", "that a rank may be silent while a job is under way (default 60)"},
                request.rank_silence, 1);
    add_limits(command, request.options.limits);
    add_seconds(command, {"--grace", "SECONDS", "for the jobs that run, when the server ends (default 30)"},
                request.options.grace, 0);
    add_seconds(command, {"--stall", "SECONDS", "that a client may take for its next message (default 60)"},
                request.options.stall, 1);
    add_state(command, request.options);
    add_access(command, request.options);
    add_watching(command, request);
}

void complete_serve_request(const Command& command, ServeRequest& request) {
    if (!request.config.empty()) apply_config(command, request.config);
    if (request.listen.empty()) throw Error(ErrorCode::usage, "serve: --listen is missing: unix:PATH or HOST:PORT");
    request.options.listen = service::parse_address(request.listen);
    if (!request.metrics.empty()) request.options.metrics = service::parse_address(request.metrics);
    check_engine_choice(request.engine);
    if (request.engine.is_server()) {
        throw Error(ErrorCode::usage, "--engine: a server looks for pairs itself; it does not ask another one");
    }
    if (request.rank_silence && !request.engine.has_ranks()) {
        throw Error(ErrorCode::usage, "--rank-timeout: only --engine mpi has ranks");
    }
}

}  // namespace octopair::cli
