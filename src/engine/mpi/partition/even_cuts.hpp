// Division of a sequence of work items into contiguous parts with about equal work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace octopair {

/// Returns the first item of each of `parts` parts, then the number of items. `work`: work of each item. Parts have about the
/// same work; a part may be empty. The result depends only on the arguments.
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
