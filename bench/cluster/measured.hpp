// What a call cost the ranks of a cluster, step by step, and what follows from it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/mpi.hpp"

namespace octopair::cluster {

/// One scene on so many ranks.
struct Setup {
    std::string scene = "uniform";  ///< a kind of samples/scenes.hpp, seed 1
    std::uint64_t objects = 0;
    unsigned ranks = 1;
    /// As the paper arranges ranks, all objects are the first one's, as there; else each has an equal part.
    Arrangement arrangement = Arrangement::shared;
    unsigned ranks_per_machine = 2;  ///< of Arrangement::paper

    bool same_call(const Setup& other) const {
        return scene == other.scene && objects == other.objects && arrangement == other.arrangement;
    }
};

/// "shared", "paper".
std::string_view arrangement_name(Arrangement arrangement);
/// Throws Error{usage} for what is neither.
Arrangement arrangement_of(std::string_view name);

/// Of each rank the median of each step.
using EachRank = std::vector<RankCosts>;

struct Measured {
    Setup setup;
    std::uint64_t pairs = 0, entries = 0;
    double wall_seconds = 0;  ///< the median of the first rank's calls
    /// While all ranks share the cores and caches of this machine; and of the same call with one rank at a time, the
    /// others asleep and what they sent at hand, as on a machine of its own.
    EachRank together, alone;

    double bytes_per_object() const;
    double messages_per_rank() const;
    /// The part of all objects that went to several ranks.
    double shared() const;
};

/// Processor seconds of computing: of one rank, of the slowest, on average.
double computing(const RankCosts& costs);
double slowest(const EachRank& ranks);
double mean(const EachRank& ranks);
inline double imbalance(const EachRank& ranks) { return slowest(ranks) / mean(ranks); }
/// The seconds of one rank, over what so many slowest ranks take.
inline double efficiency(const EachRank& one, const EachRank& ranks) {
    return slowest(one) / (double(ranks.size()) * slowest(ranks));
}

/// One step of a rank's costs.
struct Step {
    const char* name;
    double RankCosts::*seconds;
};
inline constexpr Step computing_steps[] = {
    {"join", &RankCosts::join}, {"plan", &RankCosts::plan}, {"route", &RankCosts::route},
    {"pack", &RankCosts::pack}, {"build", &RankCosts::build}, {"merge", &RankCosts::merge},
    {"scan", &RankCosts::scan}, {"order", &RankCosts::order},
};

/// JSON, an array of one object for each; and back. Throws Error{engine_failed} for text that is none.
std::string measured_json(const std::vector<Measured>& all);
std::vector<Measured> measured_of(const std::string& json);

}  // namespace octopair::cluster
