// How work in a row is cut among ranks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace octopair {

/// Where each of `parts` begins among the items, and the end: cuts between items, such that each part has about the same
/// work. A part may be empty. A function of the arguments alone.
inline std::vector<std::size_t> even_cuts(std::span<const std::uint64_t> work, std::size_t parts) {
    const double all = double(std::accumulate(work.begin(), work.end(), std::uint64_t(0)));
    std::vector<std::size_t> begins = {0};
    std::uint64_t before = 0;
    for (std::size_t item = 0; item < work.size(); ++item) {
        // An item that a cut would fall into goes to the side that has more of it.
        const double middle = double(before) + double(work[item]) / 2;
        while (begins.size() < parts && middle > all * double(begins.size()) / double(parts)) begins.push_back(item);
        before += work[item];
    }
    begins.resize(parts + 1, work.size());
    return begins;
}

}  // namespace octopair
