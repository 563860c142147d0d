#include "cli/engine_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/control_group.hpp"
#include "cli/command/command.hpp"
#include "cli/command/option_values.hpp"
#include "octopair/client.hpp"
#include "octopair/error.hpp"
#include "octopair/limits.hpp"
#include "octopair/processes.hpp"

namespace octopair::cli {

namespace {

#ifdef OCTOPAIR_WITH_PROCESSES
constexpr bool with_processes = true;
#else
constexpr bool with_processes = false;
#endif

#ifdef OCTOPAIR_WITH_SERVICE
constexpr bool with_service = true;
#else
constexpr bool with_service = false;
#endif

#ifdef OCTOPAIR_WITH_MPI
constexpr bool with_mpi = true;
#else
constexpr bool with_mpi = false;
#endif

std::string engine_help() {
    std::string help = "engine: local (default; threads)";
    if (with_processes) help += ", processes";
    if (with_mpi) help += ", mpi (ranks)";
    if (with_service) help += ", or a server (unix:PATH or HOST:PORT)";
    return help;
}

void parse_engine(const std::string& word, EngineChoice& choice) {
    if (word.find(':') != std::string::npos) {
        if (!with_service) {
            throw Error(ErrorCode::usage,
                        "--engine: '" + word +
                            "' is the address of a server; this octopair was built without servers, it has: " +
                            fmt::format("{}", fmt::join(engine_names(), ", ")));
        }
        return choice.choose_server(word);
    }
    if ((word == "processes" && !with_processes) || (word == "mpi" && !with_mpi)) {
        throw Error(ErrorCode::usage, fmt::format("--engine: this octopair was built without '{}'; it has: {}", word,
                                                  fmt::join(engine_names(), ", ")));
    }
    check_value("--engine", engine_names(), word);
    choice.kind = word == "processes" ? EngineKind::processes : word == "mpi" ? EngineKind::mpi : EngineKind::local;
}

unsigned count_or_cores(const std::optional<unsigned>& asked, unsigned most) {
    if (asked.value_or(0) > 0) return *asked;
    return std::min(available_cores(), most);
}

}  // namespace

std::vector<std::string_view> engine_names() {
    std::vector<std::string_view> names = {"local"};
    if (with_processes) names.emplace_back("processes");
    if (with_mpi) names.emplace_back("mpi");
    return names;
}

void add_engine_options(Command& command, EngineChoice& choice) {
    command.begin_section("Engine");
    command
        .add_option(
            "--engine", [&choice](const std::string& word) { parse_engine(word, choice); }, engine_help())
        .type_name("ENGINE");
    command
        .add_option(
            "--threads", [&choice](const std::string& text) { choice.threads = parse_threads(text); },
            "threads (default 0: one per core), or threads of each rank (default 1)")
        .type_name("N");
    command
        .add_option(
            "--workers",
            [&choice](const std::string& text) {
                choice.workers = unsigned(parse_count("--workers", text, max_workers));
            },
            "worker processes of --engine processes (default 0: one per core)")
        .type_name("N");
}

void check_engine_choice(const EngineChoice& choice) {
#ifdef OCTOPAIR_WITH_SERVICE
    check_server_choice(choice.server);
#endif
    if (choice.kind == EngineKind::server && (choice.threads || choice.workers)) {
        throw Error(ErrorCode::usage, std::string(choice.threads ? "--threads" : "--workers") +
                                          ": not with a server, which sets its own number (octopair serve)");
    }
    if (choice.kind == EngineKind::local && choice.workers) {
        throw Error(ErrorCode::usage, "--workers: only with --engine processes; the local engine has --threads");
    }
    if (choice.kind == EngineKind::mpi && choice.workers) {
        throw Error(ErrorCode::usage, "--workers: not with --engine mpi; mpirun -n sets the number of ranks");
    }
    if (choice.kind == EngineKind::processes && choice.threads) {
        throw Error(ErrorCode::usage,
                    "--threads: not with --engine processes; --workers sets the number of worker processes");
    }
}

std::unique_ptr<Engine> make_engine(const EngineChoice& choice) {
    if (choice.kind == EngineKind::mpi)
        throw Error(ErrorCode::usage, "--engine mpi: only `octopair detect` and `octopair serve` can run on ranks");
#ifdef OCTOPAIR_WITH_PROCESSES
    if (choice.kind == EngineKind::processes) return make_process_engine(choice.workers.value_or(0));
#endif
#ifdef OCTOPAIR_WITH_SERVICE
    if (choice.kind == EngineKind::server) {
        return connect(choice.server.address, client_options(choice.server));
    }
#endif
    return make_local_engine(choice.threads.value_or(0));
}

void EngineChoice::choose_server(std::string address) {
    kind = EngineKind::server;
    server.address = std::move(address);
}

EngineChoice EngineChoice::with_width(unsigned width) const {
    EngineChoice choice = *this;
    (has_workers() ? choice.workers : choice.threads) = width;
    return choice;
}

EngineDescription describe_engine(const EngineChoice& choice) {
    if (choice.kind == EngineKind::processes) return {"processes", 0, count_or_cores(choice.workers, max_workers)};
    if (choice.kind == EngineKind::server) return {.engine = "server", .server = choice.server.address};
    if (choice.kind == EngineKind::mpi) return {"mpi", count_or_cores(choice.threads.value_or(1), max_threads), 0};
    return {"local", count_or_cores(choice.threads, max_threads), 0};
}

unsigned local_threads(const EngineChoice& choice) {
    if (choice.kind == EngineKind::mpi) return describe_engine(choice).threads;
    return choice.threads ? *choice.threads : choice.workers.value_or(0);
}

}  // namespace octopair::cli
