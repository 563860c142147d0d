// Times of a call by number of threads and of ranks, and derived quantities.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace octopair::scaling {

/// Engine of a measurement: the local engine with threads, or ranks with threads each.
struct Setup {
    unsigned ranks = 0;  ///< 0: the local engine
    unsigned threads = 1;

    bool local() const { return ranks == 0; }
    unsigned processes() const { return local() ? 1 : ranks; }
    unsigned cores() const { return processes() * threads; }
    bool operator==(const Setup&) const = default;
};

/// Returns text such as "2 threads", "1 rank" or "2 ranks x 4 threads".
std::string setup_text(const Setup& setup);

struct Entrant {
    Setup setup;
    std::uint64_t objects = 0, pairs = 0;
    std::vector<double> seconds;  ///< wall clock of each call, from the first begin to the last end of a rank

    double median() const;
};

/// One scene: all setups take turns on it, round by round.
struct Contest {
    std::string scene = "uniform";  ///< kind of samples/scenes.hpp, seed 1
    std::uint64_t objects = 0;
    bool weak = false;  ///< true: `objects` counts per core, not in total
    std::vector<Entrant> entrants;

    std::uint64_t objects_of(const Setup& setup) const { return weak ? objects * setup.cores() : objects; }
    /// Returns the entrant with this setup, or null.
    const Entrant* find(const Setup& setup) const;
    /// Returns the number of objects in equal time, relative to one thread of the local engine. Requires: an entrant
    /// with one local thread.
    double speedup(const Entrant& entrant) const;
    double efficiency(const Entrant& entrant) const { return speedup(entrant) / entrant.setup.cores(); }
    /// Returns the time of ranks over the time of the local engine with as many threads; 0 if no entrant has as many
    /// threads.
    double against_threads(const Entrant& entrant) const;
};

/// Returns the local engine with each number of threads, then ranks. For each number of threads per rank, ranks cover
/// each number of cores that this number divides. Requires: threads and cores ascend and contain 1.
std::vector<Setup> setups(const std::vector<unsigned>& cores, const std::vector<unsigned>& threads_per_rank);

/// Writes a table for people; writes or reads JSON for programs. Throws: Error{engine_failed} for text of another form.
std::string contest_text(const Contest& contest);
std::string contest_json(const Contest& contest);
Contest contest_of(const std::string& json);

// contest_on_ranks.cpp

/// Runs a part on all ranks. Throws: an equal Error on all ranks if the part threw on any rank.
using Together = std::function<void(const std::function<void()>&)>;

struct Turns {
    std::vector<Setup> setups;  ///< the first is the local engine with one thread
    unsigned rounds = 7;
};

/// Collective. All setups take turns for the given number of rounds, after one uncounted call each, with engines and
/// lists kept. The local engine runs on rank 0; a setup of r ranks runs on the first r. Ranks without a part in a call
/// sleep. Pairs are listed in octal order, and stay on the ranks that found them. Rank 0 returns `contest` with all
/// entrants. Throws: Error{usage} if there are fewer ranks than a setup has; Error{engine_failed} if two setups find
/// different numbers of pairs among equal numbers of objects.
Contest hold_on_ranks(MPI_Comm comm, Contest contest, const Turns& turns, const Together& together,
                      const std::stop_token& stop);

}  // namespace octopair::scaling
