// PairCount: a number of pairs that may be a lower bound. CountLimit: decides when pairs that are too many are counted far enough.
#pragma once

#include <chrono>
#include <cstdint>

namespace octopair {

/// If `exact` is false, there are more than `pairs` pairs.
struct PairCount {
    std::uint64_t pairs;
    bool exact = true;

    bool exceeds(std::uint64_t most) const { return exact ? pairs > most : pairs >= most; }
};

struct CountLimit {
    using Clock = std::chrono::steady_clock;

    std::uint64_t room = ~std::uint64_t(0);            ///< up to this number, pairs are always counted
    Clock::time_point end = Clock::time_point::max();  ///< more pairs are counted until this time

    bool reached(std::uint64_t pairs) const { return pairs > room && Clock::now() >= end; }
};

}  // namespace octopair
