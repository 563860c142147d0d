#include "octree/dynamic/mutable_octree.hpp"

#include <hwy/cache_control.h>

#include <algorithm>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/build/encoder.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

namespace {

// How many visits ahead run() prefetches the data that a visit reads.
constexpr std::size_t ahead_head = 24, ahead_first = 14, ahead_next = 6;

/// True if two boxes overlap or are adjacent on each axis. Then joined() is on no axis longer than the two boxes together.
bool near(const CellBox& a, const CellBox& b) {
    bool is_near = true;
    for (unsigned axis = 0; axis < 3; ++axis) is_near &= a.lo[axis] <= b.hi[axis] + 1 && b.lo[axis] <= a.hi[axis] + 1;
    return is_near;
}

CellBox joined(const CellBox& a, const CellBox& b) {
    CellBox both;
    for (unsigned axis = 0; axis < 3; ++axis) {
        both.lo[axis] = std::min(a.lo[axis], b.lo[axis]);
        both.hi[axis] = std::max(a.hi[axis], b.hi[axis]);
    }
    return both;
}

/// build() first adds one of this many ranges of octants, and predicts from it the memory for all ranges.
constexpr std::size_t sample_stride = 32;

/// Divides the octants into at least `sample_stride` ranges if there are enough entries. Returns the first octant of each
/// range, then the number of octants.
std::vector<OctantIndex> ranges_of(const LinearOctree& octree) {
    const auto octants = OctantIndex(octree.directory().octants().size());
    const std::uint64_t most = std::clamp<std::uint64_t>(
        octree.entry_count() / sample_stride, tuning().dynamic.min_range_entries, tuning().dynamic.range_entries);
    std::vector<OctantIndex> begins;
    if (octants > 0) begins.push_back(0);
    for (OctantIndex octant = 1; octant < octants; ++octant) {
        if (octree.entry_count(begins.back(), octant + 1) > most) begins.push_back(octant);
    }
    begins.push_back(octants);
    return begins;
}

}  // namespace

/// Calls visit(unit, octant) for each unit of an octant that keeps an entry of `box`.
template <typename Visit>
void MutableOctree::for_each_unit_of(OctantIndex octant, const CellBox& box, Visit&& visit) const {
    const LeafGrid& grid = grids_[octant];
    const GridRange range = grid.range_of(box);
    if (!grid.keeps_in(range)) {
        count_path(grid.inner ? Path::unit_of_inner : Path::unit_of_leaf);
        return visit(grid.own_unit(), octant);
    }
    count_path(Path::unit_in_cell);
    grid.for_each_cell(range, [&](const Unit& unit, const auto&) { visit(unit, octant); });
}

/// Calls visit(unit, octant of the unit) for each unit that keeps an entry of `box`.
template <typename Visit>
void MutableOctree::for_each_home_unit(const CellBox& box, Visit&& visit) const {
    const Directory::Leaf home = directory_.leaf(box.lo);
    if (within(box, home.level())) return for_each_unit_of(home.octant(), box, visit);
    for_each_octant_of(box, directory_, home,
                       [&](OctantIndex octant, unsigned) { for_each_unit_of(octant, box, visit); });
}

/// Calls visit(octant) for `octant`, and for all octants below that `box` touches.
template <typename Visit>
void MutableOctree::for_each_octant_below(OctantIndex octant, const CellBox& box, Visit&& visit) const {
    visit(octant);
    if (!grids_[octant].inner) return;
    for (unsigned digit = 0; digit < 8; ++digit) {
        const OctantIndex child = directory_.child(directory_.octants()[octant], digit);
        if (grids_[child].touches(box)) for_each_octant_below(child, box, visit);
    }
}

/// Calls visit(octant) for all leaves that `box` touches, and for all inner octants that keep `box` or may hold entries that
/// touch it.
template <typename Visit>
void MutableOctree::for_each_touched_octant(const CellBox& box, Visit&& visit) const {
    const auto octants = directory_.octants();
    const Directory::Leaf home = directory_.leaf(box.lo);
    if (within(box, home.level())) {
        visit(home.octant());
        if (!inner_used_) return;
        for (OctantIndex octant = home.octant(); octant != 0;) {
            octant = octants[octant].parent;
            visit(octant);
        }
        return;
    }
    std::array<OctantIndex, 8> tops;
    std::size_t count = 0;
    for_each_octant_of(box, directory_, home, [&](OctantIndex octant, unsigned) { tops[count++] = octant; });
    for (std::size_t i = 0; i < count; ++i) {
        for_each_octant_below(tops[i], box, visit);
        if (!inner_used_) continue;
        // Visits the ancestors of this top. Ends at an ancestor of an earlier top: it has been visited, and so have its ancestors.
        for (OctantIndex octant = tops[i]; octant != 0;) {
            octant = octants[octant].parent;
            const auto above = [&](OctantIndex top) { return octant < top && top < octants[octant].next; };
            if (std::any_of(tops.begin(), tops.begin() + std::ptrdiff_t(i), above)) break;
            visit(octant);
        }
    }
}

/// Adds octants in ranges; a range is a share. A few ranges are added first, to predict the memory that all ranges need.
void MutableOctree::build(const LinearOctree& octree, const LoadBounds& load_bounds, Executor& executor,
                          const std::stop_token& stop) {
    clear();
    space_ = octree.space();
    directory_ = octree.directory();
    grids_.resize(directory_.octants().size());
    const std::vector<OctantIndex> begins = ranges_of(octree);
    const std::size_t ranges = begins.size() - 1;
    const auto add = [&](std::size_t range) {
        throw_if_stopped(stop);
        add_range(octree, begins[range], begins[range + 1], load_bounds);
    };
    try {
        const std::size_t first = (ranges + sample_stride - 1) / sample_stride;
        executor.for_each(first, [&](std::size_t i) { add(i * sample_stride); });
        // Reserves twice the expected memory, which also leaves room for later changes. Reserved memory is committed only when it is
        // used. An array that had to grow later would exist twice for a while.
        const std::uint64_t of_one = 2 * (ranges / std::max<std::size_t>(1, first) + 1);
        units_.reserve(units_.blocks() * of_one, units_.units() * of_one);
        executor.for_each(ranges - first, [&](std::size_t i) { add(i + i / (sample_stride - 1) + 1); });
    } catch (...) {
        clear();
        throw;
    }
    for (OctantIndex octant = 0; octant < grids_.size(); ++octant) {
        if (!units_.empty(grids_[octant].begin)) use({&octant, 1});
    }
}

/// Adds the grids of the octants [begin, end), and their entries.
void MutableOctree::add_range(const LinearOctree& octree, OctantIndex begin, OctantIndex end,
                              const LoadBounds& load_bounds) {
    std::vector<Entry> entries;
    entries.reserve(octree.entry_count(begin, end));
    for (OctantIndex octant = begin; octant < end; ++octant) {
        octree.for_each_run(octant, [&](std::span<const CellEntry> run) {
            for (const CellEntry& entry : run) entries.push_back({{}, {}, entry.object, 0});
        });
    }
    load_bounds(entries);
    std::vector<CellBox> boxes(entries.size());
    space_.cells(entries, boxes);

    std::vector<UnitEntry> unit_entries;
    unit_entries.reserve(entries.size() + entries.size() / 2);
    std::vector<std::uint32_t> sizes;  // number of entries of each unit of the range
    std::size_t first = 0;
    for (OctantIndex octant = begin; octant < end; ++octant) {
        const std::size_t count = octree.entry_count(octant);
        grids_[octant] = LeafGrid::cut(directory_.octants()[octant], std::uint32_t(sizes.size()),
                                       std::span(boxes).subspan(first, count));
        sizes.resize(sizes.size() + grids_[octant].units(), 0);
        for (std::size_t i = first; i < first + count; ++i) {
            for_each_unit_of(octant, boxes[i], [&](const Unit& unit, OctantIndex) {
                unit_entries.push_back({unit.index, entries[i].object, unit.small(boxes[i])});
                ++sizes[unit.index];
            });
        }
        first += count;
    }
    const std::uint32_t first_unit = units_.add(sizes, unit_entries);
    for (OctantIndex octant = begin; octant < end; ++octant) grids_[octant].begin += first_unit;
}

void MutableOctree::clear() {
    directory_ = {};
    grids_.clear();
    units_.clear();
    inner_used_ = false;
}

void MutableOctree::release() {
    clear();
    grids_ = {};
    units_.release();
}

void MutableOctree::insert(std::uint32_t object, const CellBox& box) {
    for_each_home_unit(box, [&](const Unit& unit, OctantIndex octant) {
        if (unit.index == grids_[octant].begin) use({&octant, 1});
        units_.reserve(1);
        units_.put(unit.index, unit.small(box), object);
    });
}

void MutableOctree::erase(std::uint32_t object, const CellBox& box) {
    for_each_home_unit(box, [&](const Unit& unit, OctantIndex) { units_.take(unit.index, object); });
}

void MutableOctree::prefetch(const OctreeChange& change) const {
    if (!grids_.empty()) hwy::Prefetch(&grids_[directory_.leaf(change.after.lo).octant()]);
}

void MutableOctree::use(std::span<const OctantIndex> octants) {
    for (const OctantIndex octant : octants) {
        grids_[octant].used = true;
        inner_used_ |= grids_[octant].inner;
    }
}

void MutableOctree::search(const CellBox& box, std::vector<std::uint32_t>& found) const {
    if (grids_.empty()) return;
    const auto search_one = [&](const Unit& unit) {
        units_.search(unit.index, unit.small(box), [&](std::uint32_t object) { found.push_back(object); });
    };
    for_each_touched_octant(box, [&](OctantIndex octant) {
        const LeafGrid& grid = grids_[octant];
        if (grid.used) search_one(grid.own_unit());
        if (grid.inner) return;
        grid.for_each_cell(grid.range_of(box), [&](const Unit& unit, const auto&) { search_one(unit); });
    });
}

Unit MutableOctree::unit_at(const Cell& cell) const {
    const LeafGrid& grid = grids_[directory_.leaf(cell).octant()];
    Unit unit;
    grid.for_each_cell(grid.range_of({cell, cell}), [&](const Unit& at, const auto&) { unit = at; });
    return unit;
}

/// One search of a change, the box whose entries the change removes, and the box whose entries the change adds.
struct MutableOctree::Work {
    std::uint32_t number;
    std::uint32_t object;
    std::uint8_t around;
    CellBox wanted;
    const CellBox* take = nullptr;
    const CellBox* put = nullptr;

    static unsigned natural(const CellBox* box) { return box == nullptr ? 0 : natural_level(*box); }
    unsigned natural_take = natural(take), natural_put = natural(put);
};

void MutableOctree::list_octant(OctantIndex octant, const Work& work, Visits& out) const {
    const LeafGrid& grid = grids_[octant];
    // The units of this octant that keep entries of a box: some cells, the own unit, or no unit.
    struct Keepers {
        GridRange cells = GridRange::empty();
        bool own = false;
    };
    const auto keepers = [&](const CellBox* box, unsigned natural) {
        Keepers found;
        if (box == nullptr || !grid.keeps(*box, natural)) return found;
        const GridRange range = grid.range_of(*box);
        found.own = !grid.keeps_in(range);
        if (!found.own) found.cells = range;
        return found;
    };
    const Keepers taken = keepers(work.take, work.natural_take), put = keepers(work.put, work.natural_put);
    const auto add = [&](const Unit& unit, bool take_here, bool put_here) {
        UnitVisit& visit = out.visits.emplace_back();
        visit = {unit.index, work.number, work.object, work.around, take_here, put_here, unit.small(work.wanted), {}};
        if (put_here) visit.entry = unit.small(*work.put);
    };
    if (grid.used || taken.own || put.own) add(grid.own_unit(), taken.own, put.own);
    if (put.own && !grid.used) out.first_used.push_back(octant);
    if (grid.inner) return;
    const GridRange range = grid.range_of(work.wanted);
    if (range.count() > tuning().dynamic.max_listed_visits) {
        out.visits.resize(out.visits.size() + tuning().dynamic.max_listed_visits + 1);  // makes list() return false
        return;
    }
    grid.for_each_cell(range, [&](const Unit& unit, const GridRange::Place& at) {
        add(unit, taken.cells.holds(at), put.cells.holds(at));
    });
}

bool MutableOctree::list(const Work& work, Visits& out) const {
    const std::size_t visits = out.visits.size(), first_used = out.first_used.size();
    const auto too_many = [&] { return out.visits.size() > visits + tuning().dynamic.max_listed_visits; };
    for_each_touched_octant(work.wanted, [&](OctantIndex octant) {
        if (!too_many()) list_octant(octant, work, out);
    });
    if (!too_many()) return true;
    out.visits.resize(visits);
    out.first_used.resize(first_used);
    return false;
}

bool MutableOctree::list(const OctreeChange& change, std::uint32_t number, Visits& out) const {
    const std::size_t visits = out.visits.size(), first_used = out.first_used.size();
    constexpr std::uint8_t both = around_before | around_after;
    const CellBox *const before = &change.before, *const after = &change.after;
    bool listed = true;
    if (change.existed && change.exists && near(*before, *after)) {
        count_path(Path::change_joined);
        listed = list({number, change.object, both, joined(*before, *after), before, after}, out);
    } else {
        if (change.existed) listed = list({number, change.object, around_before, *before, before, nullptr}, out);
        if (change.exists && listed) {
            listed = list({number, change.object, around_after, *after, nullptr, after}, out);
        }
    }
    count_path(listed ? Path::change_listed : Path::change_alone);
    if (listed) return true;
    out.visits.resize(visits);
    out.first_used.resize(first_used);
    // The caller makes this change before all listed changes, whose searches must find the changed object. So its octants also count as
    // used for the first time.
    if (!change.exists) return false;
    for_each_home_unit(*after, [&](const Unit& unit, OctantIndex octant) {
        if (unit.index == grids_[octant].begin && !grids_[octant].used) out.first_used.push_back(octant);
    });
    return false;
}

std::size_t MutableOctree::run(std::span<const UnitVisit> visits, std::span<const std::uint64_t> order,
                               std::vector<Hit>& hits) {
    const auto visit_at = [&](std::size_t i) -> const UnitVisit& { return visits[std::uint32_t(order[i])]; };
    const auto unit_at = [&](std::size_t i) { return std::uint32_t(order[i] >> 32); };
    std::size_t i = 0;
    for (; i < order.size() && hits.size() < tuning().dynamic.hits; ++i) {
        if (i + ahead_head < order.size()) {
            units_.prefetch_head(unit_at(i + ahead_head));
            hwy::Prefetch(&visit_at(i + ahead_head));
        }
        if (i + ahead_first < order.size()) units_.prefetch_first(unit_at(i + ahead_first));
        if (i + ahead_next < order.size()) units_.prefetch_next(unit_at(i + ahead_next));
        const UnitVisit& visit = visit_at(i);
        if (visit.around != 0) {
            units_.search(visit.unit, visit.wanted, [&](std::uint32_t object) {
                if (object != visit.object) hits.push_back({visit.change, object, visit.around});
            });
        }
        if (visit.take) units_.take(visit.unit, visit.object);
        if (visit.put) units_.put(visit.unit, visit.entry, visit.object);
    }
    if (i < order.size()) count_path(Path::run_stopped);
    return i;
}

}  // namespace octopair
