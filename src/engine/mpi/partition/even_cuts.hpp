// Division of a sequence of work items into contiguous parts with about equal work.
#pragma once

#include <algorithm>
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
        // If an even cut would divide an item, the item goes to the part that has more than half of it.
        const double middle = double(before) + double(work[item]) / 2;
        while (begins.size() < parts && middle > all * double(begins.size()) / double(parts)) begins.push_back(item);
        before += work[item];
    }
    begins.resize(parts + 1, work.size());
    return begins;
}

/// Returns cuts in the form of even_cuts(). Minimizes the work of the part with most work: it exceeds the minimum by at most about
/// 1/256 of the mean. Later parts may have less work than earlier parts.
/// Source: Pinar, Aykanat 2004, Fast optimal load balancing algorithms for 1D partitioning.
inline std::vector<std::size_t> least_cuts(std::span<const std::uint64_t> work, std::size_t parts) {
    std::vector<std::uint64_t> sums(work.size() + 1, 0);
    std::inclusive_scan(work.begin(), work.end(), sums.begin() + 1);
    std::vector<std::size_t> begins;
    // Fills one part after another with items of at most `most` work. Returns false if items are left after the last part.
    const auto fill = [&](std::uint64_t most) {
        begins = {0};
        while (begins.size() <= parts) {
            const auto from = sums.begin() + std::ptrdiff_t(begins.back());
            begins.push_back(std::size_t(std::upper_bound(from, sums.end(), *from + most) - sums.begin()) - 1);
        }
        return begins.back() == work.size();
    };
    const std::uint64_t mean = sums.back() / std::max<std::size_t>(1, parts);
    const std::uint64_t largest = work.empty() ? 0 : *std::ranges::max_element(work);
    std::uint64_t too_little = std::max(mean, largest), enough = mean + largest + 1;
    if (too_little > 0) --too_little;
    while (enough - too_little > mean / 256 + 1) {
        const std::uint64_t middle = too_little + (enough - too_little) / 2;
        (fill(middle) ? enough : too_little) = middle;
    }
    fill(enough);
    return begins;
}

}  // namespace octopair
