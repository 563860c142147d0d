// EngineChoice: the engine that the command line selects, with its number of threads or workers.
//
// Only this file distinguishes the kinds of engines. Other files call the predicates of EngineChoice.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/server/server_choice.hpp"
#include "octopair/engine.hpp"

namespace octopair::cli {

class Command;

enum class EngineKind : std::uint8_t { local, processes, mpi, server };

/// The engine that the command line selects. 0 threads or workers means one per core.
struct EngineChoice {
    EngineKind kind = EngineKind::local;
    std::optional<unsigned> threads, workers;
    ServerChoice server;

    bool has_ranks() const { return kind == EngineKind::mpi; }
    bool has_workers() const { return kind == EngineKind::processes; }
    bool is_server() const { return kind == EngineKind::server; }
    /// Returns whether the engine has a Scene. Other engines find all pairs of each frame.
    bool keeps_scenes() const { return kind == EngineKind::local || kind == EngineKind::server; }
    /// Returns whether a call may run on the calling thread, without waking another thread or process.
    bool runs_in_caller() const { return kind == EngineKind::local; }
    /// Chooses the server at an address.
    void choose_server(std::string address);
    /// Returns a copy of this choice with `width` workers if the engine has workers, else with `width` threads.
    EngineChoice with_width(unsigned width) const;
};

/// Description of the engine for summaries, statistics and logs.
struct EngineDescription {
    std::string_view engine = "local";
    unsigned threads = 0;
    unsigned workers = 0;
    unsigned ranks = 0;
    std::string_view server = {};  ///< address of the server, borrowed from the EngineChoice
};

/// Returns the engines of this build, by their names for --engine. Servers are not included, because --engine takes their
/// address.
std::vector<std::string_view> engine_names();

/// Adds --engine, --threads and --workers.
void add_engine_options(Command& command, EngineChoice& choice);

/// Throws: Error{usage} for --threads, --workers or server options that the selected engine does not have.
void check_engine_choice(const EngineChoice& choice);

/// Makes the selected engine.
/// Throws: Error{usage} for --engine mpi, because `detect` and `serve` make that engine themselves; what the functions that
/// make engines throw.
std::unique_ptr<Engine> make_engine(const EngineChoice& choice);

/// Returns the description of the selected engine. `ranks` stays 0: the caller sets it. Borrows from `choice`.
EngineDescription describe_engine(const EngineChoice& choice);

/// Returns the number of threads of this process for shapes and filters. 0 means one per core. It is the given number of
/// threads, else of workers.
unsigned local_threads(const EngineChoice& choice);

}  // namespace octopair::cli
