// Which engine finds the pairs, and on how many threads or workers: the one place that knows the engines.
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

/// The engine that the command line asks for. 0 threads or workers: one per core.
struct EngineChoice {
    EngineKind kind = EngineKind::local;
    std::optional<unsigned> threads, workers;
    ServerChoice server;

    bool has_ranks() const { return kind == EngineKind::mpi; }
    bool has_workers() const { return kind == EngineKind::processes; }
    bool is_server() const { return kind == EngineKind::server; }
    /// Whether the engine has a Scene. The others find all pairs of each frame.
    bool keeps_scenes() const { return kind == EngineKind::local || kind == EngineKind::server; }
    /// Whether a call may run on the thread that made it, without waking another thread or process.
    bool runs_in_caller() const { return kind == EngineKind::local; }
    /// Returns a copy of this choice with `width` workers if the engine has workers, else with `width` threads.
    EngineChoice with_width(unsigned width) const;
};

/// Who looked for the pairs: threads of this process, workers, ranks, or a server.
struct EngineDescription {
    std::string_view engine = "local";
    unsigned threads = 0;
    unsigned workers = 0;
    unsigned ranks = 0;
    std::string_view server = {};  ///< its address, of the choice
};

/// Those that this program was built with, as --engine names them; a server goes by its address.
std::vector<std::string_view> engine_names();

/// --engine, --threads, --workers.
void add_engine_options(Command& command, EngineChoice& choice);

/// Throws Error{usage} for threads, workers or a server's options of an engine that has none.
void check_engine_choice(const EngineChoice& choice);

/// Throws what the makers of engines throw; Error{usage} for ranks, which only `detect` and `serve` have, in their own way.
std::unique_ptr<Engine> make_engine(const EngineChoice& choice);

EngineDescription describe_engine(const EngineChoice& choice);

/// Of this process, for shapes and filters: as many as were asked for, for whatever; 0: one a core.
unsigned threads_beside(const EngineChoice& choice);

}  // namespace octopair::cli
