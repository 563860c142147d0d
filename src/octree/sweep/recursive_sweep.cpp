#include "octree/sweep/recursive_sweep.hpp"

#include <algorithm>
#include <cfloat>
#include <memory>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

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

/// Sweep of a share: a tile of rows against the tiles of columns that it reaches.
struct TileSweep {
    const ScanContext& context;
    std::span<const Entry> row_entries;
    std::span<const SortKey> rows;
    std::span<const Entry> column_entries;
    std::span<const SortKey> columns;
    unsigned axis;
    SweepKind kind;
    Orientation orientation;

    void run(std::size_t t, ShareWriter& writer) const {
        PairMaker maker(context, writer);
        SweepSet row_set;
        SweepSet column_set;
        const auto row_tile = tile_of(rows, t);
        row_set.assign(row_entries, row_tile, axis);
        float reach = -FLT_MAX;
        for (std::size_t i = 0; i < row_set.size(); ++i) reach = std::max(reach, row_set.high(0)[i]);
        std::size_t first = 0;
        if (kind == SweepKind::self) {
            maker.sweep({row_set, row_set, SweepKind::self}, orientation);
            first = t + 1;
        }
        const float begin = low_of(row_tile.front());
        for (std::size_t c = first; c < tile_count(columns.size()); ++c) {
            const auto column_tile = tile_of(columns, c);
            if (low_of(column_tile.back()) < begin) {
                count_path(Path::tile_skipped);
                continue;
            }
            const float tile_begin = low_of(column_tile.front());
            if (tile_begin > reach || (planted(Fault::tile_end_open) && tile_begin == reach)) break;
            column_set.assign(column_entries, column_tile, axis);
            maker.sweep({row_set, column_set, kind == SweepKind::self ? SweepKind::cross : kind}, orientation);
        }
        maker.flush();
    }
};

/// A SweepInput between rows and columns that owns its positions.
struct OwnedJoin {
    std::span<const Entry> row_entries;
    std::span<const Entry> column_entries;
    std::shared_ptr<const std::vector<std::uint32_t>> rows;
    std::shared_ptr<const std::vector<std::uint32_t>> columns;
    Orientation orientation = {};
    unsigned settled = 0;               // number of settled axes: their orientation is given, they need no more splits
    std::array<unsigned, 3> axes = {};  // in the order in which they are settled

    SweepInput join() const {
        return {{row_entries, *rows, false}, {column_entries, *columns, false}, false, orientation};
    }
    std::size_t size() const { return rows->size() + columns->size(); }
};

using Positions = std::vector<std::uint32_t>;

std::shared_ptr<const Positions> shared_positions(Positions positions) {
    return std::make_shared<const Positions>(std::move(positions));
}

/// Appends the rows that span `range` on the axis to parts[0], and the other rows that overlap the range to parts[1].
void part_by_span(const OwnedJoin& join, unsigned axis, std::array<float, 2> range, std::array<Positions, 2>& parts) {
    for (const std::uint32_t i : *join.rows) {
        const Entry& row = join.row_entries[i];
        if (row.max[axis] < range[0] || row.min[axis] > range[1]) continue;
        const bool spans = row.min[axis] <= range[0] && row.max[axis] >= range[1];
        parts[spans ? 0 : 1].push_back(i);
    }
}

/// Returns a value near the median of the columns' low ends: some columns begin before the value, others do not.
/// Requires: `range` holds the least and the greatest low end, and these differ.
float split_value(const OwnedJoin& join, unsigned axis, std::array<float, 2> range) {
    std::vector<float> lows;
    lows.reserve(join.columns->size());
    for (const std::uint32_t i : *join.columns) lows.push_back(join.column_entries[i].min[axis]);
    const auto median = lows.begin() + std::ptrdiff_t(lows.size() / 2);
    std::nth_element(lows.begin(), median, lows.end());
    if (*median > range[0]) return *median;
    float next = range[1];
    for (const float low : lows) next = low > range[0] ? std::min(next, low) : next;
    return next;
}

/// Returns smaller joins that together find the pairs of `join`.
std::vector<OwnedJoin> split_join(const OwnedJoin& join) {
    std::vector<OwnedJoin> made;
    const unsigned axis = join.axes[join.settled];
    std::array<float, 2> range = {FLT_MAX, -FLT_MAX};
    for (const std::uint32_t i : *join.columns) {
        range[0] = std::min(range[0], join.column_entries[i].min[axis]);
        range[1] = std::max(range[1], join.column_entries[i].min[axis]);
    }
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
        for (const std::uint32_t i : parts[1]) {
            if (join.row_entries[i].min[axis] < split) low_rows.push_back(i);
            if (join.row_entries[i].max[axis] >= split) high_rows.push_back(i);
        }
        for (const std::uint32_t i : *join.columns) {
            (join.column_entries[i].min[axis] < split ? low_columns : high_columns).push_back(i);
        }
        OwnedJoin half = join;
        half.rows = shared_positions(std::move(low_rows));
        half.columns = shared_positions(std::move(low_columns));
        made.push_back(half);
        half.rows = shared_positions(std::move(high_rows));
        half.columns = shared_positions(std::move(high_columns));
        made.push_back(half);
    }
    std::erase_if(made, [](const OwnedJoin& part) { return part.rows->empty() || part.columns->empty(); });
    return made;
}

/// choose_sweep() restricted to `axes`.
SweepChoice choose_sweep_of(const SweepInput& join, SweepOrder& order, const std::stop_token& stop,
                            std::span<const unsigned> axes) {
    const std::size_t size = join.rows.size() + (join.self ? 0 : join.columns.size());
    SweepChoice choice;
    std::uint64_t least = ~std::uint64_t(0);
    for (const unsigned axis : axes) {
        std::uint64_t tests = order.tests(join.rows, join.columns, axis);
        if (!join.self) tests += order.tests(join.columns, join.rows, axis);
        if (tests < least) {
            least = tests;
            choice.axis = axis;
        }
    }
    const Tuning::Sweep& limits = tuning().sweep;
    choice.good = size <= limits.small_set || least <= limits.cheap_tests * size ||
                  least / limits.tests_per_pair <= estimated_hits(join.rows, join.columns, stop);
    return choice;
}

class Recursion {
public:
    Recursion(const ScanContext& context, Executor& executor)
        : context_(context), executor_(executor), order_(context.stop) {}

    void run(const OwnedJoin& join) {
        throw_if_stopped(context_.stop);
        // On settled axes all rows and columns overlap, so a sweep along such an axis thins nothing.
        const std::span<const unsigned> open = std::span(join.axes).subspan(join.settled);
        if (open.empty()) count_path(Path::recursion_settled);
        const SweepChoice choice =
            open.empty() ? SweepChoice{0, true} : choose_sweep_of(join.join(), order_, context_.stop, open);
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
    SweepOrder order_;
};

}  // namespace

std::array<std::vector<std::uint32_t>, 8> part_by_shape(const EntryList& list) {
    std::array<double, 3> reach{};
    for (unsigned axis = 0; axis < 3; ++axis) {
        float first = FLT_MAX;
        float last = -FLT_MAX;
        for (std::size_t i = 0; i < list.size(); ++i) {
            first = std::min(first, list[i].min[axis]);
            last = std::max(last, list[i].max[axis]);
        }
        reach[axis] = double(last) - double(first);
    }
    const auto shape_of = [&](const Entry& box) {
        unsigned shape = 0;
        for (unsigned axis = 0; axis < 3; ++axis) {
            shape |= unsigned((double(box.max[axis]) - double(box.min[axis])) * 4 > reach[axis]) << axis;
        }
        return shape;
    };
    std::array<std::size_t, 8> counts{};
    for (std::size_t i = 0; i < list.size(); ++i) ++counts[shape_of(list[i])];
    std::array<std::vector<std::uint32_t>, 8> shapes;
    for (unsigned shape = 0; shape < 8; ++shape) shapes[shape].reserve(counts[shape]);
    for (std::size_t i = 0; i < list.size(); ++i) shapes[shape_of(list[i])].push_back(list.position(i));
    return shapes;
}

SweepChoice choose_sweep(const SweepInput& join, SweepOrder& order, const std::stop_token& stop) {
    constexpr std::array<unsigned, 3> all = {0, 1, 2};
    return choose_sweep_of(join, order, stop, all);
}

void tiled_sweep(const ScanContext& context, const SweepInput& join, unsigned axis, Executor& executor) {
    SweepOrder row_order(context.stop);
    const auto rows = row_order.sort(join.rows, axis, executor);
    count_path(tile_count(rows.size()) > 1 ? Path::tiles : Path::one_tile);
    if (join.self) {
        const TileSweep sweep{context,         join.rows.entries, rows, join.rows.entries, rows, axis,
                              SweepKind::self, join.orientation};
        executor.for_each_writing(tile_count(rows.size()),
                                  [&](std::size_t t, ShareWriter& writer) { sweep.run(t, writer); });
        return;
    }
    SweepOrder column_order(context.stop);
    const auto columns = column_order.sort(join.columns, axis, executor);
    const TileSweep forth{context,          join.rows.entries, rows, join.columns.entries, columns, axis,
                          SweepKind::cross, join.orientation};
    const TileSweep back{context,
                         join.columns.entries,
                         columns,
                         join.rows.entries,
                         rows,
                         axis,
                         SweepKind::cross_strict,
                         reversed(join.orientation)};
    executor.for_each_writing(tile_count(rows.size()),
                              [&](std::size_t t, ShareWriter& writer) { forth.run(t, writer); });
    executor.for_each_writing(tile_count(columns.size()),
                              [&](std::size_t t, ShareWriter& writer) { back.run(t, writer); });
}

void recursive_sweep(const ScanContext& context, const SweepInput& join, Executor& executor) {
    SweepOrder order(context.stop);
    std::array<std::pair<std::uint64_t, unsigned>, 3> costs;
    for (unsigned axis = 0; axis < 3; ++axis) costs[axis] = {order.tests(join.rows, join.columns, axis), axis};
    std::sort(costs.begin(), costs.end());
    const auto positions = [](const EntryList& list) {
        Positions all(list.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = list.position(i);
        return shared_positions(std::move(all));
    };
    OwnedJoin whole;
    whole.row_entries = join.rows.entries;
    whole.column_entries = join.columns.entries;
    whole.rows = positions(join.rows);
    whole.columns = join.self ? whole.rows : positions(join.columns);
    whole.axes = {costs[0].second, costs[1].second, costs[2].second};
    whole.orientation[whole.axes[0]] = 1;
    Recursion recursion(context, executor);
    recursion.run(whole);
    if (join.self) return;
    std::swap(whole.rows, whole.columns);
    std::swap(whole.row_entries, whole.column_entries);
    recursion.run(whole);
}

}  // namespace octopair
