#include "octree/sweep/sweep_choice.hpp"

#include <algorithm>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

SweepChoice SweepChooser::choose(const SweepInput& join, std::span<const unsigned> axes) {
    measure(join);
    const Measured& columns = join.self ? rows_ : columns_;
    SweepChoice choice;
    std::uint64_t least = ~std::uint64_t(0);
    for (const unsigned axis : axes) {
        std::uint64_t axis_tests = tests(rows_, columns, axis);
        if (!join.self) axis_tests += tests(columns_, rows_, axis);
        if (axis_tests < least) {
            least = axis_tests;
            choice.axis = axis;
        }
    }
    const Tuning::Sweep& limits = tuning().sweep;
    choice.good = join.size() <= limits.small_set || least <= limits.cheap_tests * join.size() ||
                  least / limits.tests_per_pair <= hits(join.rows, columns);
    return choice;
}

std::array<unsigned, 3> SweepChooser::by_cost(const SweepInput& join) {
    measure(join);
    std::array<std::pair<std::uint64_t, unsigned>, 3> costs;
    for (const unsigned axis : all_axes) costs[axis] = {tests(rows_, join.self ? rows_ : columns_, axis), axis};
    std::ranges::sort(costs);
    return {costs[0].second, costs[1].second, costs[2].second};
}

void SweepChooser::measure(const SweepInput& join) {
    throw_if_stopped(stop_);
    rows_.measure(join.rows);
    if (!join.self) columns_.measure(join.columns);
}

void SweepChooser::Measured::measure(const EntryList& list) {
    const Tuning::Sweep& limits = tuning().sweep;
    const std::size_t most = std::clamp<std::size_t>(list.size() / 32, limits.min_measured, limits.max_measured);
    const Sample sample(list.size(), 1, most);
    list.load(sample, entries);
    stride = sample.stride();
}

/// Returns an estimate of the number of columns that a sweep along `axis` tests, summed over all rows.
std::uint64_t SweepChooser::tests(const Measured& rows, const Measured& columns, unsigned axis) {
    lows_.clear();
    for (const Entry& column : columns.entries) lows_.push_back(column.min[axis]);
    std::ranges::sort(lows_, NanLast());
    std::uint64_t sum = 0;
    for (const Entry& row : rows.entries) {
        const auto first = std::lower_bound(lows_.begin(), lows_.end(), row.min[axis], NanLast());
        sum += std::uint64_t(std::upper_bound(first, lows_.end(), row.max[axis], NanLast()) - first);
    }
    return sum * columns.stride * rows.stride;
}

/// Tests a few rows against the sampled columns. Returns an estimate of the number of pairs of a row and a column that overlap.
std::uint64_t SweepChooser::hits(const EntryList& rows, const Measured& columns) {
    const Sample tried(rows.size(), 1, tuning().sweep.tried_rows);
    rows.load(tried, tried_rows_);
    std::uint64_t found = 0;
    for (std::size_t r = 0; r < tried_rows_.size(); ++r) {
        throw_if_stopped(stop_);
        for (const Entry& column : columns.entries) found += overlap(tried_rows_[r], column) ? 1 : 0;
        if (r == 3 && found <= 4) {
            count_path(Path::hits_few);
            return 0;  // on average at most one hit for each of four rows, so there are few hits in total
        }
    }
    return found * tried.stride() * columns.stride;
}

}  // namespace octopair
