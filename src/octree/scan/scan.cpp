#include "octree/scan/scan.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <iterator>
#include <mutex>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/scan/scan_memory.hpp"
#include "octree/sweep/recursive_sweep.hpp"

namespace octopair {

namespace {

using Handed = std::vector<Entry>;

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

/// The own entries of inner octants, with their bounds as coordinates. Each octant's are made once, when they are first used.
/// Thread safety: any thread may call it.
class KeptEntries {
public:
    KeptEntries(const LinearOctree& octree, const EntrySource& source)
        : octree_(octree), source_(source), kept_((octree.octants().size() + 7) / 8) {}

    std::span<const Entry> of(OctantIndex inner) {
        if (octree_.entry_count(inner) == 0) return {};
        Kept& kept = kept_[octree_.octants()[inner].children];  // rows of the child table number the inner octants
        std::call_once(kept.made, [&] { kept.entries = whole_entries(octree_, inner, source_); });
        return kept.entries;
    }

private:
    struct Kept {
        std::once_flag made;
        std::vector<Entry> entries;
    };
    const LinearOctree& octree_;
    const EntrySource& source_;
    std::vector<Kept> kept_;
};

/// The entries handed down to the octants of one path, by level, each with its class bits in that octant.
class HandedDown {
public:
    /// `moved`: number of cells by which boxes are shifted, for Fault::nested_space_moved; otherwise 0.
    HandedDown(const LinearOctree& octree, KeptEntries& kept, std::uint32_t moved)
        : octree_(octree), kept_(kept), moved_(moved) {}

    /// Returns the entries that octants above keep and that touch `octant`.
    /// Requires: calls come in pre-order of octants; any octant may be the first.
    const Handed& at(OctantIndex octant) {
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

private:
    static constexpr OctantIndex none = ~OctantIndex(0);

    void hand_down(std::span<const Entry> from, OctantIndex to) {
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

    void hand_down(const Entry& entry, const CellBox& box, OctantIndex to) {
        const Octant& octant = octree_.octants()[to];
        if (octant.touches(box) == planted(Fault::handed_to_wrong_child)) return;
        count_path(Path::handed_down);
        // Class bits are added, never cleared (boxes/entry.hpp).
        Entry& handed = lists_[octant.level].emplace_back(entry);
        handed.mask |= class_bits(box, octant);
    }

    void move(CellBox& box) const {
        for (unsigned axis = 0; axis < 3; ++axis) {
            box.lo[axis] += moved_;
            box.hi[axis] += moved_;
        }
    }

    const LinearOctree& octree_;
    KeptEntries& kept_;
    std::uint32_t moved_;
    std::vector<Handed> lists_;
    std::vector<OctantIndex> owners_;
};

/// Source of a nested octree: the entries of a join, rows before columns.
class JoinSource final : public ForwardingSource {
public:
    JoinSource(const EntrySource& source, const SweepInput& join) : ForwardingSource(source), join_(join) {}
    std::size_t size() const override { return join_.size(); }
    bool load(std::size_t begin, std::span<Entry> out) const override {
        const std::size_t rows = std::min(out.size(), join_.rows.size() - std::min(begin, join_.rows.size()));
        if (rows > 0) join_.rows.load(begin, out.first(rows));
        if (rows < out.size()) join_.columns.load(begin + rows - join_.rows.size(), out.subspan(rows));
        return true;
    }
    Float32Boxes float32_boxes(std::size_t, std::span<Box3f>) const override { return {}; }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        for (std::size_t i = 0; i < out.size(); ++i) load(positions[i], out.subspan(i, 1));
    }

private:
    const SweepInput& join_;
};

/// Scans single octants.
/// Thread safety: one thread at a time.
class OctantScan {
public:
    /// Borrows all arguments but `context`.
    OctantScan(const LinearOctree& octree, const ScanContext& context, ScanMemory& memory, Executor& executor)
        : octree_(octree), context_(context), memory_(memory), executor_(executor), chooser_(context.stop) {}

    void scan(OctantIndex octant, std::span<const Entry> handed) {
        if constexpr (has_test_hooks) {
            if (context_.nesting == 0) context_.outermost = OutermostOctant{octree_.space(), octree_.octants()[octant]};
        }
        octant_ = octant;
        cells_ = OctantCells(octree_.space(), octree_.octants()[octant]);
        gaps_ = certain_gaps(cells_, context_.source);
        turns_ = 0;
        for (Crowd& crowd : crowd_of_part_) crowd.clear();
        if (runs_owner_ != octant) find_runs(octant, memory_.runs);
        memory_.next_runs.clear();
        if (octant + 1 < octree_.octants().size()) find_runs(octant + 1, memory_.next_runs);
        context_.source.join() ? scan_join(handed) : scan_self(handed);
        std::swap(memory_.runs, memory_.next_runs);
        runs_owner_ = octant + 1;
    }

private:
    void find_runs(OctantIndex octant, ScanMemory::Runs& runs) const {
        runs.clear();
        octree_.for_each_run(octant, [&](std::span<const CellEntry> run) { runs.push_back(run); });
    }

    /// Finds the pairs among the octant's own entries, and between own entries and entries handed down.
    void scan_self(std::span<const Entry> handed) {
        const std::size_t own = std::size_t(octree_.entry_count(octant_));
        if (own + handed.size() < 2) return;
        const bool laid_out = own <= tuning().scan.max_swept_list;
        laid_out ? memory_.own_set.assign(memory_.runs) : count_path(Path::own_too_large);
        if (own > 1 && !(laid_out && try_own_sweep())) {
            const EntryList crowd = crowd_of({false, any_set}, {});
            scan_crowded({crowd, crowd, true, {}});
        }
        if (!handed.empty() && !(laid_out && try_handed_sweep(handed))) {
            scan_crowded({crowd_of({true, any_set}, handed), crowd_of({false, any_set}, {}), false, {}});
        }
    }

    /// A part of the entries that meet in an octant.
    struct Part {
        bool handed;        ///< the entries handed down; otherwise the own entries
        std::uint32_t set;  ///< first_set or second_set of a join, or any_set

        bool has(std::uint32_t mask) const { return set == any_set || (mask & set) != 0; }
        std::size_t number() const { return (handed ? 2u : 0u) + (set == second_set ? 1u : 0u); }
    };
    static constexpr std::uint32_t any_set = 0;

    /// The entries of a part whose sweep on cells would cost too much: whole, or without bounds.
    struct Crowd {
        std::vector<Entry> whole;
        std::vector<EntryId> ids;

        void clear() {
            whole.clear();
            ids.clear();
        }
    };

    /// Returns a part of the octant's entries. The list is valid until the next octant is scanned.
    EntryList crowd_of(Part part, std::span<const Entry> handed) {
        if (part.handed && part.set == any_set) return EntryList(handed);
        Crowd& crowd = crowd_of_part_[part.number()];
        if (crowd.whole.empty() && crowd.ids.empty()) collect(part, handed, crowd);
        return crowd.ids.empty() ? EntryList(crowd.whole) : EntryList(context_.source, crowd.ids);
    }

    /// Collects the entries of a part with their bounds, or as ids alone if they are more than `max_whole_crowd` of all entries.
    void collect(Part part, std::span<const Entry> handed, Crowd& crowd) {
        if (part.handed) {
            std::ranges::copy_if(handed, std::back_inserter(crowd.whole),
                                 [part](const Entry& entry) { return part.has(entry.mask); });
            return;
        }
        const auto own = octree_.entry_count(octant_);
        const bool whole = double(own) <= tuning().scan.max_whole_crowd * double(octree_.entry_count());
        whole ? crowd.whole.reserve(std::size_t(own)) : crowd.ids.reserve(std::size_t(own));
        for (const auto run : memory_.runs) {
            for (const CellEntry& entry : run) {
                const std::uint32_t mask = cells_.mask_of(entry);
                if (!part.has(mask)) continue;
                whole ? crowd.whole.push_back({{}, {}, entry.object, mask}) : crowd.ids.push_back({entry.object, mask});
            }
        }
        if (whole) count_path(Path::crowd_whole);
        context_.source.load_bounds(crowd.whole);
    }

    bool try_own_sweep() {
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

    bool try_handed_sweep(std::span<const Entry> handed) {
        if (handed.size() > tuning().scan.max_swept_list) {
            count_path(Path::handed_too_large);
            return false;
        }
        memory_.handed_cells.resize(handed.size());
        cell_entries(cells_, handed, memory_.handed_cells.data());
        (void)try_lay_out(memory_.handed_cells, memory_.handed_set);
        for (unsigned turn = 0; turn < turns_; ++turn) memory_.handed_set.turn();
        const bool done = try_cross_sweeps();
        count_path(done ? Path::handed_swept : Path::handed_window_too_wide);
        return done;
    }

    /// Sorts the octant's own entries along the next axis.
    void turn_own() {
        memory_.own_set.turn();
        std::ranges::rotate(gaps_.cells, gaps_.cells.begin() + 1);
        ++turns_;
    }

    /// Finds the pairs between the two sets of a join. No set is swept against itself.
    void scan_join(std::span<const Entry> handed) {
        for (const std::uint32_t set : {first_set, second_set}) {
            collect_cells({false, set}, handed);
            collect_cells({true, set}, handed);
        }
        join(handed, {false, first_set}, {false, second_set});
        join(handed, {true, first_set}, {false, second_set});
        join(handed, {true, second_set}, {false, first_set});
    }

    /// Collects the entries of a part, or so many that they are too many for a sweep on cells.
    void collect_cells(Part part, std::span<const Entry> handed) {
        std::vector<CellEntry>& cells = memory_.cells_of_part[part.number()];
        cells.clear();
        const std::size_t most = tuning().scan.max_swept_list + 1;
        if (part.handed) {
            for (const Entry& entry : handed) {
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

    void join(std::span<const Entry> handed, Part rows, Part columns) {
        if (memory_.cells_of_part[rows.number()].empty() || memory_.cells_of_part[columns.number()].empty()) return;
        gaps_ = certain_gaps(cells_, context_.source);
        const bool done = try_lay_out(memory_.cells_of_part[rows.number()], memory_.handed_set) &&
                          try_lay_out(memory_.cells_of_part[columns.number()], memory_.own_set) && try_cross_sweeps();
        count_path(done ? Path::join_swept : Path::join_crowded);
        if (!done) scan_crowded({crowd_of(rows, handed), crowd_of(columns, handed), false, {}});
    }

    /// Returns false, with nothing done, if there are too many entries.
    static bool try_lay_out(std::span<const CellEntry> entries, CellSet& set) {
        if (entries.size() > tuning().scan.max_swept_list) return false;
        set.assign({&entries, 1});
        return true;
    }

    /// Sweeps the two sets against each other, along the first of three axes on which the sweep is cheap.
    bool try_cross_sweeps() {
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
    bool try_sweep(std::initializer_list<CellSweep> sweeps) {
        std::uint64_t tests = 0, rows = 0;
        for (const CellSweep& sweep : sweeps) {
            tests += sampled_tests(sweep);
            rows += sweep.rows.size();
        }
        if (tests > tuning().scan.max_tests_per_box * rows) return false;
        memory_.own_set.make_planes();
        if (sweeps.size() > 1) memory_.handed_set.make_planes();
        executor_.for_each_writing(1, [&](std::size_t, ShareWriter& writer) {
            for (const CellSweep& sweep : sweeps) pair_maker_.sweep(sweep, gaps_, writer);
        });
        return true;
    }

    /// Finds the pairs of a join that is too costly for a sweep along the first axis. Parts of one shape are joined
    /// separately: boxes as long as the octant prevent any sweep and any split from thinning the other boxes.
    void scan_crowded(const SweepInput& join) {
        if (try_sweep(join)) return count_path(Path::crowd_swept);
        count_path(Path::crowd_parted);
        const auto rows = part_by_shape(join.rows, context_.stop);
        const auto columns = join.self ? decltype(rows){} : part_by_shape(join.columns, context_.stop);
        for (unsigned i = 0; i < rows.size(); ++i) {
            const EntryList row_list = join.rows.at(rows[i]);
            if (join.self) scan_crowded_part({row_list, row_list, true, {}}, true);
            const unsigned first = join.self && !planted(Fault::part_joined_twice) ? i + 1 : 0;
            for (unsigned k = first; k < rows.size(); ++k) {
                if (join.self && k == i) continue;
                const EntryList column_list = join.columns.at(join.self ? rows[k] : columns[k]);
                scan_crowded_part({row_list, column_list, false, {}}, i == k);
            }
        }
    }

    void scan_crowded_part(const SweepInput& join, bool same_shape) {
        if (join.rows.size() == 0 || join.columns.size() == 0) return;
        if (try_sweep(join)) return count_path(Path::part_swept);
        // Only the two sets of the caller's join have bits in the masks. A nested octree of other rows and columns would
        // also report pairs within the rows and within the columns.
        const bool separable = join.self || context_.source.join();
        if (same_shape && separable && try_nested_scan(join)) return;
        count_path(Path::part_recursive);
        recursive_sweep(context_, join, executor_);
    }

    bool try_sweep(const SweepInput& join) {
        const SweepChoice choice = chooser_.choose(join);
        if (choice.good) tiled_sweep(context_, join, choice.axis, executor_);
        return choice.good;
    }

    /// Scans a nested octree of the join's entries. Returns false, with no pairs written, if the nesting is too deep or the
    /// octree does not thin the entries.
    bool try_nested_scan(const SweepInput& join) {
        if (context_.nesting >= tuning().scan.max_nesting) {
            count_path(Path::not_nested_depth);
            return false;
        }
        const JoinSource entries(context_.source, join);
        const BuildPlace place = executor_.build_place(entries.size());
        LinearOctree octree(place.pages);
        octree.build(entries, place.executor, context_.stop);
        if (!thins(octree, entries.size())) return false;
        ScanContext within = context_;
        ++within.nesting;
        within.growth *= double(octree.entry_count()) / double(entries.size());
        constexpr std::array nested = {Path::nested_once, Path::nested_twice, Path::nested_thrice};
        count_path(within.nesting <= nested.size() ? nested[within.nesting - 1] : Path::nested_deeper);
        if (!join.self) count_path(Path::nested_join);
        octopair::scan(octree, within, executor_, {});
        return true;
    }

    /// True if the largest octant of a nested octree holds few enough of the join's `entries`, and the octree has not
    /// multiplied the entries beyond the bound.
    bool thins(const LinearOctree& octree, std::size_t entries) const {
        std::size_t largest = 0;
        for (OctantIndex octant = 0; octant < octree.octants().size(); ++octant) {
            largest = std::max(largest, std::size_t(octree.entry_count(octant)));
        }
        const bool thinner = double(largest) <= tuning().scan.max_part_in_octant * double(entries);
        const double growth = context_.growth * double(octree.entry_count()) / double(entries);
        const bool bounded = growth <= tuning().scan.max_growth;
        if (!thinner) count_path(Path::not_nested_largest);
        if (thinner && !bounded) count_path(Path::not_nested_growth);
        return thinner && bounded;
    }

    const LinearOctree& octree_;
    ScanContext context_;
    ScanMemory& memory_;
    Executor& executor_;
    OctantIndex octant_ = 0;
    OctantIndex runs_owner_ = ~OctantIndex(0);
    SweepChooser chooser_;
    OctantCells cells_;
    CertainGaps gaps_;
    unsigned turns_ = 0;  // number of times that the own entries, and gaps_, were turned
    CellPairMaker pair_maker_{context_, memory_.pair_maker};
    std::array<Crowd, 4> crowd_of_part_;  // by Part::number(); empty until they are needed
};

/// A run of octants in pre-order that is scanned as one share. A large octant is a share alone.
struct Share {
    OctantIndex begin = 0, end = 0;
    bool large = false;
};

std::vector<Share> shares_of(const OctreeRange& octants, unsigned width) {
    const LinearOctree& octree = octants.octree;
    const std::uint64_t even =
        octree.entry_count(octants.begin, octants.end) / (std::uint64_t(width) * tuning().scan.shares_per_thread) + 1;
    const std::uint64_t most = std::min<std::uint64_t>(even, tuning().scan.max_share_entries);
    std::vector<Share> shares;
    std::uint64_t held = 0;
    for (OctantIndex octant = octants.begin; octant < octants.end; ++octant) {
        const std::size_t size = std::size_t(octree.entry_count(octant));
        const bool large = size > tuning().scan.large_octant;
        if (shares.empty() || large || shares.back().large || held + size > most) {
            shares.push_back({octant, octant, large});
            held = 0;
        }
        shares.back().end = octant + 1;
        held += size;
    }
    return shares;
}

}  // namespace

void scan(const OctreeRange& octants, const ScanContext& context, Executor& executor,
          const std::function<void(std::uint64_t)>& progress) {
    const LinearOctree& octree = octants.octree;
    const std::vector<Share> shares = shares_of(octants, executor.width());
    KeptEntries kept(octree, context.source);
    const auto scan_share = [&](const Share& share, Executor& within) {
        HandedDown handed(octree, kept, planted(Fault::nested_space_moved) && context.nesting > 0 ? 1 : 0);
        const ScanMemoryPool::Lent memory = context.memory.lend();
        OctantScan scans(octree, context, *memory, within);
        for (OctantIndex octant = share.begin; octant < share.end; ++octant) {
            const Handed& above = handed.at(octant);
            if (octree.entry_count(octant) > 0) scans.scan(octant, above);
        }
        throw_if_stopped(context.stop);
        if (progress) progress(octree.entry_count(share.begin, share.end));
    };
    for (std::size_t i = 0; i < shares.size();) {
        if (shares[i].large) {
            count_path(Path::large_octant);
            scan_share(shares[i++], executor);
            continue;
        }
        count_path(Path::share_of_octants);
        std::size_t end = i;
        while (end < shares.size() && !shares[end].large) ++end;
        executor.for_each_writing(end - i, [&](std::size_t k, ShareWriter& writer) {
            SerialExecutor serial(writer);
            scan_share(shares[i + k], serial);
        });
        i = end;
    }
}

}  // namespace octopair
