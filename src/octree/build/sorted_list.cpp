#include "octree/build/sorted_list.hpp"

#include <algorithm>

#include "base/stop.hpp"

namespace octopair {

std::uint64_t entry_count(const BuildMemory& memory, std::size_t block) {
    std::uint64_t count = 0;
    for (std::size_t list = 0; list < memory.lists.lists(); ++list) {
        memory.lists.for_each_run(block, list, [&](std::span<const CellEntry> run) { count += run.size(); });
    }
    return count;
}

void sort_block(const BuildMemory& memory, std::size_t block, const MergedList& sorted) {
    std::uint64_t at = 0;
    const auto append = [&](std::span<const CellEntry> run) {
        std::copy(run.begin(), run.end(), sorted.entries.data() + at);
        at += run.size();
    };
    for (std::size_t octant = 0; octant < memory.octants; ++octant) {
        sorted.home_begins[octant] = at;
        memory.lists.for_each_run(block, memory.home_list(octant), append);
        sorted.ghost_begins[octant] = at;
        memory.lists.for_each_run(block, memory.ghost_list(octant), append);
    }
}

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
