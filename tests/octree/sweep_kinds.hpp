// The two kinds of sweep, for tests: how to make entries and sorted sets of each kind, and which hits and pairs a sweep finds.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "octree/sweep/box_sweep.hpp"
#include "octree/sweep/cell_sweep.hpp"
#include "octree/sweep/start_order.hpp"

namespace octopair::test {

inline constexpr SweepKind sweep_kinds[] = {SweepKind::self, SweepKind::cross, SweepKind::cross_strict};

/// Positions of a row and of a column that hits it.
using Positions = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// find_hits() or find_hits_scalar() of a kind of sweep.
template <typename Sweep>
using Kernel = std::size_t (*)(const Sweep&, typename Sweep::Cursor&, std::span<typename Sweep::Hit>);

/// Returns all hits of a sweep, collected through a buffer of `room` elements.
template <typename Sweep>
std::vector<typename Sweep::Hit> run(Kernel<Sweep> kernel, const Sweep& sweep, std::size_t room) {
    std::vector<typename Sweep::Hit> hits, some(room);
    typename Sweep::Cursor cursor;
    while (cursor.row < sweep.rows.size()) {
        const std::size_t count = kernel(sweep, cursor, some);
        hits.insert(hits.end(), some.begin(), some.begin() + std::ptrdiff_t(count));
    }
    return hits;
}

/// A box on a grid of places 0 to GridBox::last, with a mask of 5 bits. Both kinds of sweep can have it as an entry.
struct GridBox {
    static constexpr std::uint32_t last = 31;
    std::array<std::uint32_t, 3> low, high;
    std::uint32_t mask = 0;
};

/// Sweeps on boxes.
struct BoxKind {
    using Sweep = BoxSweep;
    using Set = BoxSet;
    using Item = Entry;
    static constexpr const char* name = "Boxes";

    /// Returns random entries. A few are far longer; many have equal ends.
    static std::vector<Entry> random_entries(std::mt19937& random, std::size_t count, std::uint32_t first_object) {
        std::uniform_int_distribution<int> place(0, 12), length(0, 3), mask(0, 31);
        std::vector<Entry> entries(count);
        for (std::size_t i = 0; i < count; ++i) {
            const int times = random() % 16 == 0 ? 5 : 1;
            for (int axis = 0; axis < 3; ++axis) {
                entries[i].min[axis] = float(place(random));
                entries[i].max[axis] = entries[i].min[axis] + float(times * length(random));
            }
            entries[i].object = first_object + std::uint32_t(i);
            entries[i].mask = std::uint32_t(mask(random) & mask(random) & mask(random));
        }
        return entries;
    }

    static Entry entry(const GridBox& box, std::uint32_t object) {
        Entry entry{{}, {}, object, box.mask};
        for (unsigned axis = 0; axis < 3; ++axis) {
            entry.min[axis] = float(box.low[axis]);
            entry.max[axis] = float(box.high[axis]);
        }
        return entry;
    }

    /// Returns a set for sweeps along `axis`.
    static BoxSet sorted_set(const std::vector<Entry>& entries, unsigned axis) {
        std::vector<SortKey> order(entries.size());
        for (std::uint32_t i = 0; i < entries.size(); ++i) order[i] = sort_key(entries[i].min[axis], i);
        std::sort(order.begin(), order.end());
        std::vector<Entry> sorted;
        for (const SortKey key : order) sorted.push_back(entries[position_of(key)]);
        BoxSet set;
        set.assign(sorted, axis);
        return set;
    }

    static Entry item(const BoxSet& set, std::size_t i) { return set.entry(i); }

    /// True if the entries overlap and share no bit of their masks.
    static bool is_pair(const Entry& a, const Entry& b) { return overlap(a, b) && (a.mask & b.mask) == 0; }

    /// True if column `k` does not begin before row `i`, or begins after it if `strict`.
    static bool in_order(const BoxSweep& sweep, std::size_t i, std::size_t k, bool strict) {
        const float row = sweep.rows.low(0)[i], column = sweep.columns.low(0)[k];
        return strict ? column > row : column >= row;
    }

    static Positions positions(std::span<const BoxHits> hits) {
        Positions positions;
        for (const BoxHits& hit : hits) {
            for (unsigned bit = 0; bit < BoxSweep::row_block; ++bit) {
                if (hit.bits() >> bit & 1u) positions.emplace_back(hit.first_row() + bit, hit.column());
            }
        }
        return positions;
    }

    /// Returns the pairs of objects of hits. A hit of boxes is a pair.
    static std::vector<Pair> pairs(const BoxSweep& sweep, std::vector<BoxHits> hits) {
        std::vector<Pair> pairs(hits.size() * BoxHits::max_count);
        pairs.resize(write_pairs(sweep, hits, 0, pairs.data()));
        return pairs;
    }
};

/// Sweeps on cells.
struct CellKind {
    using Sweep = CellSweep;
    using Set = CellSet;
    using Item = CellEntry;
    static constexpr const char* name = "Cells";

    /// Returns random entries of an octant. A few fill the octant; many have equal ends.
    static std::vector<CellEntry> random_entries(std::mt19937& random, std::size_t count, std::uint32_t first_object,
                                                 std::uint32_t max_extent = 4000) {
        std::vector<CellEntry> entries(count);
        const std::uint32_t step = random() % 2 == 0 ? 1 : 800;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::uint32_t& ends : entries[i].ends) {
                auto low = std::uint32_t(random() % (last_octant_cell + 1)) / step * step;
                auto high = std::min(low + std::uint32_t(random() % max_extent) / step * step, last_octant_cell);
                if (random() % 20 == 0) low = 0;
                if (random() % 20 == 0) high = last_octant_cell;
                ends = low | high << 16 | (std::uint32_t(random() & random() & random()) & CellEntry::flag_bits);
            }
            entries[i].object = first_object + std::uint32_t(i);
        }
        return entries;
    }

    static CellEntry entry(const GridBox& box, std::uint32_t object) {
        constexpr std::uint32_t scale = last_octant_cell / GridBox::last;
        CellEntry entry{{}, object};
        for (unsigned k = 0; k < 3; ++k) {
            entry.ends[k] = box.low[k] * scale | box.high[k] * scale << 16 | OctantCells().flags_of(box.mask, k);
        }
        return entry;
    }

    /// Returns a set for sweeps along `axis`.
    static CellSet sorted_set(std::span<const CellEntry> entries, unsigned axis = 0) {
        // Several runs, as an octree has them.
        std::vector<std::span<const CellEntry>> runs;
        for (std::size_t begin = 0; begin < entries.size(); begin += 7) {
            runs.push_back(entries.subspan(begin, std::min<std::size_t>(7, entries.size() - begin)));
        }
        CellSet set;
        set.assign(runs);
        for (unsigned turn = 0; turn < axis; ++turn) set.turn();
        set.make_planes();
        return set;
    }

    static CellEntry item(const CellSet& set, std::size_t i) { return set.entries()[i]; }

    /// True if the entries overlap and share no flag.
    static bool is_pair(const CellEntry& a, const CellEntry& b) {
        bool overlaps = reports(a, b);
        for (unsigned k = 0; k < 3; ++k) overlaps &= a.low(k) <= b.high(k) && b.low(k) <= a.high(k);
        return overlaps;
    }

    /// True if the bucket of column `k` is not before that of row `i`, or is behind it if `strict`.
    static bool in_order(const CellSweep& sweep, std::size_t i, std::size_t k, bool strict) {
        const unsigned shift = std::max(sweep.rows.bucket_shift(), sweep.columns.bucket_shift());
        const std::uint32_t row = item(sweep.rows, i).low(0) >> shift, column = item(sweep.columns, k).low(0) >> shift;
        return strict ? column > row : column >= row;
    }

    static Positions positions(std::span<const CellHit> hits) {
        Positions positions;
        for (const CellHit hit : hits) positions.emplace_back(hit >> 16, hit & 0xFFFFu);
        return positions;
    }

    /// Returns the pairs of objects of hits. Drops hits that overlap in their high bits alone.
    static std::vector<Pair> pairs(const CellSweep& sweep, std::vector<CellHit> hits) {
        std::vector<Pair> pairs(hits.size() + judged_room);
        std::vector<std::uint32_t> doubtful(hits.size() + judged_room);
        JudgedHits judged{.pairs = pairs.data(), .doubtful = doubtful.data()};
        judge_hits_scalar(sweep, hits, {}, judged);
        pairs.resize(judged.pair_count);
        return pairs;
    }
};

}  // namespace octopair::test
