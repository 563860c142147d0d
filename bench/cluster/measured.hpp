// Costs of a call on the ranks of a cluster, step by step, and derived quantities.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/mpi.hpp"

namespace octopair::cluster {

/// How ranks divide the work.
enum class Arrangement : std::uint8_t {
    shared,  ///< octopair's: each rank has an equal part of the objects, and the ranks share every step
    space,   ///< the same, but all objects are sorted along a curve through space. Pairs are counted, not listed
    blocks,  ///< the same, but each rank has the objects of a block of space. Pairs are counted, not listed
    paper,   ///< the paper's: rank 0 has all objects at first, and merges and scans alone (paper_master.hpp)
};

/// One scene on a number of ranks.
struct Setup {
    std::string scene = "uniform";  ///< kind of samples/scenes.hpp, seed 1
    std::uint64_t objects = 0;
    unsigned ranks = 1;
    Arrangement arrangement = Arrangement::shared;
    unsigned ranks_per_machine = 2;  ///< only for Arrangement::paper

    bool same_call(const Setup& other) const {
        return scene == other.scene && objects == other.objects && arrangement == other.arrangement;
    }
};

/// Returns "shared", "space", "blocks" or "paper".
std::string_view arrangement_name(Arrangement arrangement);
/// Returns the arrangement with this name. Throws: Error{usage} if no arrangement has this name.
Arrangement arrangement_of(std::string_view name);

/// Costs of a call on a rank. Only the paper's algorithm merges.
struct Costs : RankCosts {
    double merge = 0;  ///< seconds of merging sorted lists
};
/// For each rank.
using EachRank = std::vector<Costs>;

struct Measured {
    Setup setup;
    std::uint64_t pairs = 0, entries = 0;
    double wall_seconds = 0;  ///< median over the calls of rank 0
    /// `together`: all ranks share the cores and caches of this machine. `alone`: one rank at a time repeats the call
    /// with the received data at hand, like on its own machine; other ranks sleep. `together` has the medians of each step over the calls,
    /// `alone` the steps of the call that took least.
    EachRank together, alone;

    double bytes_per_object() const;
    double messages_per_rank() const;
    /// Returns the part of all objects that several ranks received.
    double shared() const;
};

/// Returns the processor seconds of computing: of one rank, of the slowest rank, or on average.
double computing(const Costs& costs);
double slowest(const EachRank& ranks);
double mean(const EachRank& ranks);
inline double imbalance(const EachRank& ranks) { return slowest(ranks) / mean(ranks); }
/// Returns the seconds of one rank over the number of ranks times the seconds of the slowest rank.
inline double efficiency(const EachRank& one, const EachRank& ranks) {
    return slowest(one) / (double(ranks.size()) * slowest(ranks));
}

/// One step in the costs of a rank.
struct Step {
    const char* name;
    double Costs::*seconds;
};
inline constexpr Step computing_steps[] = {
    {"join", &Costs::join},   {"plan", &Costs::plan},   {"route", &Costs::route}, {"pack", &Costs::pack},
    {"build", &Costs::build}, {"merge", &Costs::merge}, {"scan", &Costs::scan},   {"order", &Costs::order},
};

/// Writes or reads a JSON array with one object per measurement. Throws: Error{engine_failed} for text of another form.
std::string measured_json(const std::vector<Measured>& all);
std::vector<Measured> measured_of(const std::string& json);

// measured_on_ranks.cpp

/// Collective. Measures `rounds` calls of all ranks together, then at least as many calls of each rank alone. Warm-up
/// calls are not counted. Each rank makes its slice of the scene. Rank 0 returns the costs of all ranks. Pairs are
/// listed in octal order (or counted, see Arrangement), by ranks with one thread.
Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop);

}  // namespace octopair::cluster
