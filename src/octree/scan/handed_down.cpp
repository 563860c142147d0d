#include "octree/scan/handed_down.hpp"

#include <algorithm>
#include <array>

#include "base/test_hooks.hpp"
#include "boxes/entry.hpp"
#include "octree/plan/octant_cells.hpp"

namespace octopair {

namespace {

/// Returns the entries of an octant with their bounds as coordinates, made again from the caller's boxes.
std::vector<Entry> whole_entries(const LinearOctree& octree, OctantIndex octant, const EntrySource& source) {
    std::vector<Entry> whole;
    whole.reserve(std::size_t(octree.entry_count(octant)));
    const OctantCells cells(octree.space(), octree.octants()[octant]);
    octree.for_each_run(octant, [&](std::span<const CellEntry> run) {
        for (const CellEntry& entry : run) whole.push_back({{}, {}, entry.object, cells.mask_of(entry)});
    });
    source.load_bounds(whole);
    return whole;
}

}  // namespace

KeptEntries::KeptEntries(const LinearOctree& octree, const EntrySource& source)
    : octree_(octree), source_(source), kept_((octree.octants().size() + 7) / 8) {}

std::span<const Entry> KeptEntries::of(OctantIndex inner) {
    if (octree_.entry_count(inner) == 0) return {};
    Kept& kept = kept_[octree_.octants()[inner].children];  // rows of the child table number the inner octants
    std::call_once(kept.made, [&] { kept.entries = whole_entries(octree_, inner, source_); });
    return kept.entries;
}

std::span<const Entry> HandedDown::at(OctantIndex octant) {
    const unsigned level = octree_.octants()[octant].level;
    if (lists_.size() <= level) {
        lists_.resize(level + 1);
        owners_.resize(level + 1, none);
    }
    if (owners_[level] == octant) return lists_[level];
    if (level == 0) {
        lists_[0].clear();
    } else {
        const OctantIndex parent = octree_.octants()[octant].parent;
        (void)at(parent);
        lists_[level].clear();
        hand_down(lists_[level - 1], octant);
        hand_down(kept_.of(parent), octant);
    }
    owners_[level] = octant;
    return lists_[level];
}

void HandedDown::hand_down(std::span<const Entry> from, OctantIndex to) {
    std::array<CellBox, 64> cells;
    while (!from.empty()) {
        const auto some = from.first(std::min(from.size(), cells.size()));
        octree_.space().cells(some, cells);
        for (std::size_t i = 0; i < some.size(); ++i) {
            if (has_test_hooks) move(cells[i]);
            hand_down(some[i], cells[i], to);
        }
        from = from.subspan(some.size());
    }
}

void HandedDown::hand_down(const Entry& entry, const CellBox& box, OctantIndex to) {
    const Octant& octant = octree_.octants()[to];
    if (octant.touches(box) == planted(Fault::handed_to_wrong_child)) return;
    count_path(Path::handed_down);
    Entry& handed = lists_[octant.level].emplace_back(entry);
    handed.mask |= class_bits(box, octant);
}

void HandedDown::move(CellBox& box) const {
    for (unsigned axis = 0; axis < 3; ++axis) {
        box.lo[axis] += moved_;
        box.hi[axis] += moved_;
    }
}

}  // namespace octopair
