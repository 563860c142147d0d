// How long a call takes on so many threads, and on so many ranks, and what follows from it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octopair::scaling {

/// Who finds the pairs: the local engine on threads, or ranks with so many threads each.
struct Setup {
    unsigned ranks = 0;  ///< 0: the local engine
    unsigned threads = 1;

    bool local() const { return ranks == 0; }
    unsigned processes() const { return local() ? 1 : ranks; }
    unsigned cores() const { return processes() * threads; }
    bool operator==(const Setup&) const = default;
};

/// "2 threads", "1 rank", "2 ranks x 4 threads".
std::string setup_text(const Setup& setup);

struct Entrant {
    Setup setup;
    std::uint64_t objects = 0, pairs = 0;
    std::vector<double> seconds;  ///< wall clock of each call, from the first rank's begin to the last one's end

    double median() const;
};

/// What the ranks are held to: the time of ranks over that of as many threads.
struct Aim {
    unsigned cores = 1;
    double most = 1;
};
inline constexpr Aim aims[] = {{1, 1.15}, {2, 1.3}};

/// One scene: all setups take turns on it, round by round.
struct Contest {
    std::string scene = "uniform";  ///< a kind of samples/scenes.hpp, seed 1
    std::uint64_t objects = 0;
    bool weak = false;  ///< so many objects a core, not in all
    std::vector<Entrant> entrants;

    std::uint64_t objects_of(const Setup& setup) const { return weak ? objects * setup.cores() : objects; }
    /// Null where there is none.
    const Entrant* find(const Setup& setup) const;
    /// Objects in the same time, against one thread of the local engine, which is among the entrants.
    double speedup(const Entrant& entrant) const;
    double efficiency(const Entrant& entrant) const { return speedup(entrant) / entrant.setup.cores(); }
    /// Of ranks: their time over that of the local engine with as many threads as they have cores; 0 where it has none.
    double against_threads(const Entrant& entrant) const;
    /// The same for an aim's ranks of one thread; 0 where they are none.
    double reached(const Aim& aim) const;
};

/// The local engine with each number of threads; then, for each number of threads a rank, as many cores made of ranks where
/// these divide. Threads and cores ascend, 1 among them.
std::vector<Setup> setups(const std::vector<unsigned>& cores, const std::vector<unsigned>& threads_per_rank);

/// A table for people; JSON for programs, and back. Throws Error{engine_failed} for text that is none.
std::string contest_text(const Contest& contest);
std::string contest_json(const Contest& contest);
Contest contest_of(const std::string& json);

}  // namespace octopair::scaling
