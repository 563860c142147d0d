// What a call cost the ranks of a cluster, step by step, and what follows from it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/mpi.hpp"

namespace octopair::cluster {

/// One scene on so many ranks.
struct Setup {
    std::string scene = "uniform";  ///< a kind of samples/scenes.hpp, seed 1
    std::uint64_t objects = 0;
    unsigned ranks = 1;
};

struct Measured {
    Setup setup;
    std::uint64_t pairs = 0, entries = 0;
    double wall_seconds = 0;       ///< the median of the first rank's calls
    std::vector<RankCosts> ranks;  ///< of each rank the median of each step

    /// Processor seconds of computing: of one rank, of the slowest, on average.
    static double computing(const RankCosts& costs);
    double slowest() const;
    double mean() const;
    double imbalance() const { return slowest() / mean(); }
    double bytes_per_object() const;
    double messages_per_rank() const;
    /// The part of all objects that went to several ranks.
    double shared() const;
    /// The seconds of one rank alone, over what so many slowest ranks take.
    double efficiency(const Measured& alone) const { return alone.slowest() / (double(setup.ranks) * slowest()); }
};

/// One step of a rank's costs.
struct Step {
    const char* name;
    double RankCosts::*seconds;
};
inline constexpr Step computing_steps[] = {
    {"join", &RankCosts::join},   {"plant", &RankCosts::plant}, {"route", &RankCosts::route},
    {"pack", &RankCosts::pack},   {"build", &RankCosts::build}, {"scan", &RankCosts::scan},
    {"order", &RankCosts::order},
};

/// JSON, an array of one object for each; and back. Throws Error{engine_failed} for text that is none.
std::string measured_json(const std::vector<Measured>& all);
std::vector<Measured> measured_of(const std::string& json);

}  // namespace octopair::cluster
