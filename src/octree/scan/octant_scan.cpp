#include "octree/scan/octant_scan.hpp"

#include <algorithm>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

/// Returns false, with nothing done, if there are too many entries.
bool try_lay_out(std::span<const CellEntry> entries, CellSet& set) {
    if (entries.size() > tuning().scan.max_swept_list) return false;
    set.assign({&entries, 1});
    return true;
}

}  // namespace

void OctantScan::scan(OctantIndex octant, std::span<const Entry> handed) {
    if constexpr (has_test_hooks) {
        if (context_.nesting == 0 && context_.source.has_all_bounds())
            context_.outermost = OutermostOctant{octree_.space(), octree_.octants()[octant]};
    }
    octant_ = octant;
    handed_ = handed;
    cells_ = OctantCells(octree_.space(), octree_.octants()[octant]);
    depths_ = certain_depths(cells_, context_.source);
    turns_ = 0;
    if (crowd_scan_) crowd_scan_->clear();
    if (runs_owner_ != octant) find_runs(octant, memory_.runs);
    memory_.next_runs.clear();
    if (octant + 1 < octree_.octants().size()) find_runs(octant + 1, memory_.next_runs);
    context_.source.join() ? scan_join() : scan_self();
    std::swap(memory_.runs, memory_.next_runs);
    runs_owner_ = octant + 1;
}

void OctantScan::find_runs(OctantIndex octant, ScanMemory::Runs& runs) const {
    runs.clear();
    octree_.for_each_run(octant, [&](std::span<const CellEntry> run) { runs.push_back(run); });
}

/// Finds the pairs among the octant's own entries, and between own entries and entries handed down.
void OctantScan::scan_self() {
    const std::size_t own = std::size_t(octree_.entry_count(octant_));
    if (own + handed_.size() < 2) return;
    const bool laid_out = own <= tuning().scan.max_swept_list;
    laid_out ? memory_.own_set.assign(memory_.runs) : count_path(Path::own_too_large);
    if (own > 1 && !(laid_out && try_own_sweep())) scan_crowd({}, {});
    if (!handed_.empty() && !(laid_out && try_handed_sweep())) scan_crowd({.handed = true}, {});
}

/// Finds the pairs between the two sets of a join. No set is swept against itself.
void OctantScan::scan_join() {
    for (const std::uint32_t set : {first_set, second_set}) {
        collect_cells({false, set});
        collect_cells({true, set});
    }
    join({false, first_set}, {false, second_set});
    join({true, first_set}, {false, second_set});
    join({true, second_set}, {false, first_set});
}

void OctantScan::join(OctantPart rows, OctantPart columns) {
    if (memory_.cells_of_part[rows.number()].empty() || memory_.cells_of_part[columns.number()].empty()) return;
    depths_ = certain_depths(cells_, context_.source);
    const bool done = try_lay_out(memory_.cells_of_part[rows.number()], memory_.handed_set) &&
                      try_lay_out(memory_.cells_of_part[columns.number()], memory_.own_set) && try_cross_sweeps();
    count_path(done ? Path::join_swept : Path::join_crowded);
    if (!done) scan_crowd(rows, columns);
}

void OctantScan::scan_crowd(OctantPart rows, OctantPart columns) {
    if (!crowd_scan_) crowd_scan_.emplace(octree_, context_, executor_);
    crowd_scan_->scan({cells_, memory_.runs, handed_}, rows, columns);
}

bool OctantScan::try_own_sweep() {
    RunPrefetcher ahead(memory_.next_runs);
    const CellSweep sweep{memory_.own_set, memory_.own_set, SweepKind::self, &ahead};
    bool done = try_sweep({sweep});
    for (unsigned axis = 1; !done && axis < 3; ++axis) {
        turn_own();
        done = try_sweep({sweep});
        if (done) count_path(Path::swept_on_other_axis);
    }
    count_path(done ? Path::own_swept : Path::own_window_too_wide);
    return done;
}

bool OctantScan::try_handed_sweep() {
    if (handed_.size() > tuning().scan.max_swept_list) {
        count_path(Path::handed_too_large);
        return false;
    }
    memory_.handed_cells.resize(handed_.size());
    cell_entries(cells_, handed_, memory_.handed_cells.data());
    (void)try_lay_out(memory_.handed_cells, memory_.handed_set);
    for (unsigned turn = 0; turn < turns_; ++turn) memory_.handed_set.turn();
    const bool done = try_cross_sweeps();
    count_path(done ? Path::handed_swept : Path::handed_window_too_wide);
    return done;
}

/// Sweeps the two sets against each other, along the first of three axes on which the sweep is cheap.
bool OctantScan::try_cross_sweeps() {
    const CellSweep down{memory_.handed_set, memory_.own_set, SweepKind::cross};
    const CellSweep up{memory_.own_set, memory_.handed_set, SweepKind::cross_strict};
    bool done = try_sweep({down, up});
    for (unsigned axis = 1; !done && axis < 3; ++axis) {
        turn_own();
        memory_.handed_set.turn();
        done = try_sweep({down, up});
        if (done) count_path(Path::swept_on_other_axis);
    }
    return done;
}

/// Runs the sweeps and returns true, unless they would test too many columns for each row.
bool OctantScan::try_sweep(std::initializer_list<CellSweep> sweeps) {
    std::uint64_t tests = 0, rows = 0;
    for (const CellSweep& sweep : sweeps) {
        tests += sampled_tests(sweep);
        rows += sweep.rows.size();
    }
    if (tests > tuning().scan.max_tests_per_box * rows) return false;
    memory_.own_set.make_planes();
    if (sweeps.size() > 1) memory_.handed_set.make_planes();
    executor_.for_each_writing(1, [&](std::size_t, ShareWriter& writer) {
        for (const CellSweep& sweep : sweeps) pair_maker_.sweep(sweep, depths_, writer);
    });
    return true;
}

/// Collects the entries of a part, or so many that they are too many for a sweep on cells.
void OctantScan::collect_cells(OctantPart part) {
    std::vector<CellEntry>& cells = memory_.cells_of_part[part.number()];
    cells.clear();
    const std::size_t most = tuning().scan.max_swept_list + 1;
    if (part.handed) {
        for (const Entry& entry : handed_) {
            if (part.has(entry.mask) && cells.size() < most) cells.push_back(cells_.entry(entry));
        }
        return;
    }
    const std::size_t flag = part.set == first_set ? 0 : 1;  // CellEntry::ends
    for (const auto run : memory_.runs) {
        for (const CellEntry& entry : run) {
            if (entry.ends[flag] >> 31 != 0 && cells.size() < most) cells.push_back(entry);
        }
    }
}

/// Sorts the octant's own entries along the next axis.
void OctantScan::turn_own() {
    memory_.own_set.turn();
    std::ranges::rotate(depths_.cells, depths_.cells.begin() + 1);
    ++turns_;
}

}  // namespace octopair
