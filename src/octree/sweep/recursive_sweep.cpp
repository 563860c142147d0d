#include "octree/sweep/recursive_sweep.hpp"

#include <algorithm>
#include <cfloat>
#include <memory>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "boxes/invalid_box.hpp"
#include "octree/sweep/start_order.hpp"

namespace octopair {

namespace {

/// Returns tile `t` of `order`. A set of at most two tiles is treated as a single tile.
std::span<const SortKey> tile_of(std::span<const SortKey> order, std::size_t t) {
    const std::size_t tile = tuning().sweep.tile;
    if (order.size() <= 2 * tile) return order;
    return order.subspan(t * tile, std::min(tile, order.size() - t * tile));
}

std::size_t tile_count(std::size_t size) {
    const std::size_t tile = tuning().sweep.tile;
    return size == 0 ? 0 : size <= 2 * tile ? 1 : (size + tile - 1) / tile;
}

/// Entries in the order of a sweep, divided into tiles.
struct SortedTiles {
    EntryList entries;
    std::span<const SortKey> keys;

    std::size_t size() const { return tile_count(keys.size()); }
    float begin(std::size_t t) const { return low_of(tile_of(keys, t).front()); }
    float last(std::size_t t) const { return low_of(tile_of(keys, t).back()); }
};

/// The boxes of one tile at a time.
class LoadedTile {
public:
    LoadedTile(const SortedTiles& tiles, unsigned axis) : tiles_(&tiles), axis_(axis) {}

    /// Loads a tile, unless it is the tile of the last call.
    const BoxSet& load(std::size_t t) {
        if (t == loaded_) return set_;
        tiles_->entries.load(tile_of(tiles_->keys, t), entries_);
        set_.assign(entries_.span(), axis_);
        loaded_ = t;
        return set_;
    }

private:
    const SortedTiles* tiles_;
    unsigned axis_;
    std::size_t loaded_ = ~std::size_t(0);
    Buffer<Entry> entries_;
    BoxSet set_;
};

/// Sweep of tiles of rows, each against the tiles of columns that it reaches.
struct TileSweep {
    const ScanContext& context;
    SortedTiles rows;
    SortedTiles columns;
    unsigned axis;
    SweepKind kind;
    Orientation orientation;

    /// Runs the sweep in shares. A share has a few adjacent tiles of rows, because these mostly reach the same tiles of columns.
    void run(Executor& executor) const {
        const std::size_t tiles = rows.size();
        const std::size_t share = std::clamp<std::size_t>(tiles / (shares_per_thread * executor.width()), 1, max_share);
        executor.for_each_writing((tiles + share - 1) / share, [&](std::size_t i, ShareWriter& writer) {
            BoxPairMaker maker(context, writer);
            LoadedTile row_tile(rows, axis), column_tile(columns, axis);
            for (std::size_t t = i * share; t < std::min((i + 1) * share, tiles); ++t) {
                sweep(t, row_tile.load(t), column_tile, maker);
                // In a self sweep, the tile of columns that was loaded last is often the next tile of rows: reuse it.
                if (kind == SweepKind::self) std::swap(row_tile, column_tile);
            }
            maker.flush();
        });
    }

private:
    static constexpr std::size_t shares_per_thread = 4, max_share = 8;

    /// Sweeps tile `t` of the rows.
    void sweep(std::size_t t, const BoxSet& row_set, LoadedTile& column_tile, BoxPairMaker& maker) const {
        float reach = -FLT_MAX;
        for (std::size_t i = 0; i < row_set.size(); ++i) reach = std::max(reach, row_set.high(0)[i]);
        std::size_t first = 0;
        if (kind == SweepKind::self) {
            maker.sweep({row_set, row_set, SweepKind::self}, orientation);
            first = t + 1;
        }
        for (std::size_t c = first; c < columns.size(); ++c) {
            if (columns.last(c) < rows.begin(t)) {
                count_path(Path::tile_skipped);
                continue;
            }
            const float begin = columns.begin(c);
            if (begin > reach || (planted(Fault::tile_end_open) && begin == reach)) break;
            const BoxSet& column_set = column_tile.load(c);
            maker.sweep({row_set, column_set, kind == SweepKind::self ? SweepKind::cross : kind}, orientation);
        }
    }
};

/// A SweepInput between rows and columns that owns the positions of its rows and columns in their lists.
struct OwnedJoin {
    EntryList row_entries;
    EntryList column_entries;
    std::shared_ptr<const std::vector<std::uint32_t>> rows;
    std::shared_ptr<const std::vector<std::uint32_t>> columns;
    Orientation orientation = {};
    unsigned depth = 0;                 // number of splits from the whole join to this join
    unsigned settled = 0;               // number of settled axes: on these, all rows and columns overlap
    std::array<unsigned, 3> axes = {};  // the axes, in the order in which the recursion settles them

    EntryList row_list() const { return row_entries.at(*rows); }
    EntryList column_list() const { return column_entries.at(*columns); }
    SweepInput join() const { return {row_list(), column_list(), false, orientation}; }
    std::size_t size() const { return rows->size() + columns->size(); }
};

using Positions = std::vector<std::uint32_t>;

std::shared_ptr<const Positions> shared_positions(Positions positions) {
    return std::make_shared<const Positions>(std::move(positions));
}

/// Appends the rows that span `range` on the axis to parts[0], and the other rows that overlap the range to parts[1].
void part_by_span(const OwnedJoin& join, unsigned axis, std::array<float, 2> range, std::array<Positions, 2>& parts) {
    join.row_list().for_each([&](std::uint32_t position, const Entry& row) {
        if (row.max[axis] < range[0] || row.min[axis] > range[1]) return;
        const bool spans = row.min[axis] <= range[0] && row.max[axis] >= range[1];
        parts[spans ? 0 : 1].push_back(position);
    });
}

/// Returns a value near the median of the columns' low ends: some columns begin before the value, others do not.
/// Requires: `range` holds the least and the greatest low end, and these differ.
float split_value(const OwnedJoin& join, unsigned axis, std::array<float, 2> range) {
    std::vector<float> lows;
    lows.reserve(join.columns->size());
    join.column_list().for_each([&](std::uint32_t, const Entry& column) { lows.push_back(column.min[axis]); });
    const auto median = lows.begin() + std::ptrdiff_t(lows.size() / 2);
    std::nth_element(lows.begin(), median, lows.end(), NanLast());
    if (*median > range[0]) return *median;
    float next = range[1];
    for (const float low : lows) next = low > range[0] ? std::min(next, low) : next;
    return next;
}

/// Maximum number of splits from the whole join to a part. On each of three axes, two successive splits at least halve the number of
/// columns, which is below 2^32. So 33 halvings leave no column. Only boxes that change during the search need more splits.
constexpr unsigned max_depth = 3 * 2 * 33;

/// Returns smaller joins that together find the pairs of `join`.
/// Throws: Error{bad_input} beyond max_depth.
std::vector<OwnedJoin> split_join(const OwnedJoin& join) {
    if (join.depth == max_depth) throw_object_changed();
    std::vector<OwnedJoin> made;
    const unsigned axis = join.axes[join.settled];
    std::array<float, 2> range = {FLT_MAX, -FLT_MAX};
    join.column_list().for_each([&](std::uint32_t, const Entry& column) {
        range[0] = std::min(range[0], column.min[axis]);
        range[1] = std::max(range[1], column.min[axis]);
    });
    std::array<Positions, 2> parts;
    part_by_span(join, axis, range, parts);

    if (!parts[0].empty()) {
        count_path(Path::recursion_spanning);
        OwnedJoin spanning = join;
        spanning.rows = shared_positions(std::move(parts[0]));
        spanning.settled = join.settled + 1;
        if (spanning.settled == 3) {
            made.push_back(spanning);
        } else {
            const unsigned next = join.axes[spanning.settled];
            OwnedJoin swapped = spanning;
            std::swap(swapped.rows, swapped.columns);
            std::swap(swapped.row_entries, swapped.column_entries);
            swapped.orientation = reversed(spanning.orientation);
            spanning.orientation[next] = swapped.orientation[next] = 1;
            made.push_back(spanning);
            made.push_back(swapped);
        }
    }
    if (!parts[1].empty()) {
        count_path(Path::recursion_halved);
        const float split = split_value(join, axis, range);
        Positions low_rows, high_rows, low_columns, high_columns;
        join.row_entries.at(parts[1]).for_each([&](std::uint32_t position, const Entry& row) {
            if (row.min[axis] < split) low_rows.push_back(position);
            if (row.max[axis] >= split) high_rows.push_back(position);
        });
        join.column_list().for_each([&](std::uint32_t position, const Entry& column) {
            (column.min[axis] < split ? low_columns : high_columns).push_back(position);
        });
        OwnedJoin half = join;
        half.rows = shared_positions(std::move(low_rows));
        half.columns = shared_positions(std::move(low_columns));
        made.push_back(half);
        half.rows = shared_positions(std::move(high_rows));
        half.columns = shared_positions(std::move(high_columns));
        made.push_back(half);
    }
    std::erase_if(made, [](const OwnedJoin& part) { return part.rows->empty() || part.columns->empty(); });
    for (OwnedJoin& part : made) part.depth = join.depth + 1;
    return made;
}

class Recursion {
public:
    Recursion(const ScanContext& context, Executor& executor)
        : context_(context), executor_(executor), chooser_(context.stop) {}

    void run(const OwnedJoin& join) {
        throw_if_stopped(context_.stop);
        // On settled axes all rows and columns overlap, so a sweep along such an axis thins nothing.
        const std::span<const unsigned> open = std::span(join.axes).subspan(join.settled);
        if (open.empty()) count_path(Path::recursion_settled);
        const SweepChoice choice = open.empty() ? SweepChoice{0, true} : chooser_.choose(join.join(), open);
        if (choice.good) {
            count_path(Path::recursion_swept);
            return tiled_sweep(context_, join.join(), choice.axis, executor_);
        }
        std::vector<OwnedJoin> parts = split_join(join);
        // Large parts run one after another, each on all threads. Runs of small parts run concurrently, one part a share.
        for (std::size_t i = 0; i < parts.size();) {
            std::size_t end = i;
            while (end < parts.size() && parts[end].size() <= tuning().sweep.large_join) ++end;
            if (end == i || executor_.width() == 1) {
                const OwnedJoin part = std::move(parts[i]);
                run(part);
                ++i;
                continue;
            }
            count_path(Path::recursion_shared);
            executor_.for_each_writing(end - i, [&](std::size_t k, ShareWriter& writer) {
                SerialExecutor serial(writer);
                Recursion(context_, serial).run(parts[i + k]);
            });
            i = end;
        }
    }

private:
    const ScanContext& context_;
    Executor& executor_;
    SweepChooser chooser_;
};

}  // namespace

std::array<std::vector<std::uint32_t>, 8> part_by_shape(const EntryList& list, const std::stop_token& stop) {
    std::array<float, 3> first = {FLT_MAX, FLT_MAX, FLT_MAX}, last = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    throw_if_stopped(stop);
    list.for_each([&](std::uint32_t, const Entry& box) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            first[axis] = std::min(first[axis], box.min[axis]);
            last[axis] = std::max(last[axis], box.max[axis]);
        }
    });
    std::vector<std::uint8_t> shape_of(list.size());
    std::array<std::size_t, 8> counts{};
    std::uint8_t* next = shape_of.data();
    throw_if_stopped(stop);
    list.for_each([&](std::uint32_t, const Entry& box) {
        unsigned shape = 0;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double reach = double(last[axis]) - double(first[axis]);
            shape |= unsigned((double(box.max[axis]) - double(box.min[axis])) * 4 > reach) << axis;
        }
        *next++ = std::uint8_t(shape);
        ++counts[shape];
    });
    std::array<std::vector<std::uint32_t>, 8> shapes;
    throw_if_stopped(stop);
    for (unsigned shape = 0; shape < 8; ++shape) shapes[shape].reserve(counts[shape]);
    for (std::size_t i = 0; i < list.size(); ++i) shapes[shape_of[i]].push_back(list.position(i));
    return shapes;
}

void tiled_sweep(const ScanContext& context, const SweepInput& join, unsigned axis, Executor& executor) {
    StartOrder row_order(context.stop);
    const SortedTiles rows{join.rows, row_order.sort(join.rows, axis, executor)};
    count_path(rows.size() > 1 ? Path::tiles : Path::one_tile);
    if (join.self) {
        return TileSweep{context, rows, rows, axis, SweepKind::self, join.orientation}.run(executor);
    }
    StartOrder column_order(context.stop);
    const SortedTiles columns{join.columns, column_order.sort(join.columns, axis, executor)};
    TileSweep{context, rows, columns, axis, SweepKind::cross, join.orientation}.run(executor);
    TileSweep{context, columns, rows, axis, SweepKind::cross_strict, reversed(join.orientation)}.run(executor);
}

void recursive_sweep(const ScanContext& context, const SweepInput& join, Executor& executor) {
    const auto positions = [](const EntryList& list) {
        Positions all(list.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = list.position(i);
        return shared_positions(std::move(all));
    };
    OwnedJoin whole;
    whole.row_entries = join.rows;
    whole.column_entries = join.columns;
    whole.rows = positions(join.rows);
    whole.columns = join.self ? whole.rows : positions(join.columns);
    whole.axes = SweepChooser(context.stop).by_cost(join);
    whole.orientation[whole.axes[0]] = 1;
    Recursion recursion(context, executor);
    recursion.run(whole);
    if (join.self) return;
    std::swap(whole.rows, whole.columns);
    std::swap(whole.row_entries, whole.column_entries);
    recursion.run(whole);
}

}  // namespace octopair
