// One scene: all engines take turns, round by round, on equal boxes, and their pairs are compared.
//
// Each engine and its list are kept from call to call. The first call of each engine is recorded separately, because it
// touches new memory. Comparison of pairs is not timed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

struct Contest {
    std::string kind;
    std::uint64_t objects;
    Order order;
    unsigned rounds;
};

struct Entrant {
    std::string engine;
    double start_seconds = 0;  ///< start of the engine
    double first_seconds = 0;  ///< first call
    std::vector<double> seconds;
    std::uint64_t pairs = 0;
    bool agrees = true;  ///< true: pairs equal the first engine's pairs, pair by pair

    double median() const;
};

/// Returns all contests, with `rounds` rounds for large scenes and ten times as many for small scenes.
std::vector<Contest> contests(unsigned rounds);

/// Runs a contest with `width` threads or workers per engine. Returns the entrants in the order of contenders().
std::vector<Entrant> hold(const Contest& contest, unsigned width);

}  // namespace octopair::bench
