#include "octree/build/sorted_list.hpp"

#include <algorithm>

#include "base/stop.hpp"

namespace octopair {

std::uint64_t merge_lists(std::span<const SortedList> lists, const MergedList& merged, const std::stop_token& stop) {
    std::uint64_t at = 0;
    const auto append = [&](const SortedList& list, std::uint64_t begin, std::uint64_t end) {
        const auto part = list.entries.subspan(begin, end - begin);
        std::copy(part.begin(), part.end(), merged.entries.data() + at);
        at += part.size();
    };
    const std::size_t octants = merged.home_begins.size();
    for (std::size_t octant = 0; octant < octants; ++octant) {
        if (octant % 256 == 0) throw_if_stopped(stop);
        merged.home_begins[octant] = at;
        for (const SortedList& list : lists) append(list, list.home_begins[octant], list.ghost_begins[octant]);
        if (!merged.ghost_begins.empty()) merged.ghost_begins[octant] = at;
        for (const SortedList& list : lists) {
            const bool last = octant + 1 == octants;
            append(list, list.ghost_begins[octant], last ? list.entries.size() : list.home_begins[octant + 1]);
        }
    }
    return at;
}

}  // namespace octopair
