// One scene: all engines take turns, round by round, on the same boxes, and what they find is compared.
//
// Each engine and its list are kept from call to call. The first call of each is told apart: it meets memory that is new.
// What is compared is not timed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/engine.hpp"

namespace octopair::bench {

/// Of the medians of two engines: how many times as long as the other's, or how many seconds more.
enum class Measure : std::uint8_t { ratio, difference };

struct Aim {
    std::string engine, against;
    Measure measure = Measure::ratio;
    bool at_most = true;  ///< else at least
    double bound = 1;
};

struct Contest {
    std::string kind;
    std::uint64_t objects;
    Order order;
    unsigned rounds;
    std::vector<Aim> aims;
};

struct Entrant {
    std::string engine;
    double start_seconds = 0;  ///< to make it
    double first_seconds = 0;  ///< the first call
    std::vector<double> seconds;
    std::uint64_t pairs = 0;
    bool agrees = true;  ///< with the first engine, pair by pair

    double median() const;
};

/// What an aim bounds. Throws std::out_of_range for an engine that is not there.
double reached(const Aim& aim, const std::vector<Entrant>& entrants);
bool kept(const Aim& aim, const std::vector<Entrant>& entrants);

/// With so many rounds for the large scenes; the small ones have ten times as many.
std::vector<Contest> contests(unsigned rounds);

/// In the order of contenders(), each with `width` threads or workers.
std::vector<Entrant> hold(const Contest& contest, unsigned width);

}  // namespace octopair::bench
