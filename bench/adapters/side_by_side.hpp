// Times of two contenders that take turns: the host's own broad phase, and octopair's.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "machine/median.hpp"

namespace octopair::bench {

inline double seconds_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Prints medians in seconds as milliseconds, and how many times as fast the second is.
inline void print_medians(const std::string& name, double of_host, double of_octopair) {
    std::printf("%-44s %10.2f ms %10.2f ms %8.1f times\n", name.c_str(), 1e3 * of_host, 1e3 * of_octopair,
                of_host / of_octopair);
    std::fflush(stdout);
}

/// Runs both in turns, `rounds` times after a round that is not counted. Prints the medians.
inline void print_side_by_side(const std::string& name, unsigned rounds, const std::function<void()>& host,
                               const std::function<void()>& octopair) {
    std::vector<double> of_host, of_octopair;
    for (unsigned round = 0; round <= rounds; ++round) {
        const double first = seconds_of(host), second = seconds_of(octopair);
        if (round == 0 && rounds > 0) continue;
        of_host.push_back(first);
        of_octopair.push_back(second);
    }
    print_medians(name, median(of_host), median(of_octopair));
}

}  // namespace octopair::bench
