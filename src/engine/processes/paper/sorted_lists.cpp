#include "engine/processes/paper/sorted_lists.hpp"

#include <algorithm>

#include "octopair/error.hpp"

namespace octopair {

SortedLists::SortedLists(const EntrySource& source, Arena& arena, std::size_t lists, const std::stop_token& stop)
    : source_(source), arena_(arena), layout_(make_layout(source, stop)), memory_(arena), heads_(arena) {
    const std::size_t octants = layout_.directory.octants().size();
    memory_.resize(source.size(), lists, octants, lists);
    heads_.resize_discard(lists);
    for (std::size_t i = 0; i < lists; ++i) {
        blocks_.push_back({i, {source.size() * i / lists, source.size() * (i + 1) / lists}});
        const std::size_t objects = blocks_[i].objects.end - blocks_[i].objects.begin;
        entries_.emplace_back(arena).reserve_discard(max_entries_per_object * objects + 1);
        begins_.emplace_back(arena).resize_discard(2 * octants);
    }
}

void SortedLists::make(std::size_t list, const std::stop_token& stop) {
    const NumberedBlock& block = blocks_[list];
    const BuildSteps steps{source_, layout_.space, layout_.directory, memory_, stop};
    steps.encode_and_scatter(block);
    const std::size_t octants = memory_.octants;
    const auto homes = begins_[list].span().first(octants), ghosts = begins_[list].span().subspan(octants);
    std::uint64_t entries = 0;
    if (memory_.valid[list] != 0) {
        entries = entry_count(memory_, list);
        entries_[list].commit(0, std::size_t(entries) + 1);
        sort_block(memory_, list, {entries_[list].span(), homes, ghosts});
    }
    heads_[list] = {arena_.offset(entries_[list].data()),
                    entries,
                    arena_.offset(homes.data()),
                    arena_.offset(ghosts.data()),
                    octants,
                    memory_.valid[list],
                    block.objects.begin};
}

SortedList find_list(SharedMemory& arena, std::uint64_t head_at, const ListBounds& bounds) {
    const auto check = [](bool good) {
        if (!good) throw Error(ErrorCode::engine_failed, "shared memory: the sorted list of a worker is damaged");
    };
    check(head_at % alignof(SortedListHead) == 0);
    const SortedListHead head = *arena.array<SortedListHead>(head_at, 1);
    if (head.valid == 0) throw LinearOctree::Invalid{std::size_t(head.object_begin)};
    check(head.octants == bounds.octants && head.entries % alignof(CellEntry) == 0 && head.home_begins % 8 == 0 &&
          head.ghost_begins % 8 == 0);
    const SortedList list{{arena.array<CellEntry>(head.entries, head.entry_count), std::size_t(head.entry_count)},
                          {arena.array<std::uint64_t>(head.home_begins, head.octants), std::size_t(head.octants)},
                          {arena.array<std::uint64_t>(head.ghost_begins, head.octants), std::size_t(head.octants)}};
    std::uint64_t at = 0;
    for (std::size_t octant = 0; octant < list.home_begins.size(); ++octant) {
        check(at <= list.home_begins[octant] && list.home_begins[octant] <= list.ghost_begins[octant]);
        at = list.ghost_begins[octant];
    }
    check(at <= list.entries.size());
    std::uint64_t highest = 0;
    for (const CellEntry& entry : list.entries) highest = std::max<std::uint64_t>(highest, entry.object);
    check(list.entries.empty() || highest < bounds.objects);
    return list;
}

}  // namespace octopair
