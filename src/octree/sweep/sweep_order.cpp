#include "octree/sweep/sweep_order.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

/// Returns the sample of a list from which its costs are estimated.
Sample measured(const EntryList& list) {
    const Tuning::Sweep& limits = tuning().sweep;
    return {list.size(), 1, std::clamp<std::size_t>(list.size() / 32, limits.min_measured, limits.max_measured)};
}

}  // namespace

SweepOrder::Buckets SweepOrder::buckets_for(const EntryList& list, unsigned axis) {
    float first = FLT_MAX;
    float last = -FLT_MAX;
    for (std::size_t i = 0; i < list.size(); ++i) {
        first = std::min(first, list[i].min[axis]);
        last = std::max(last, list[i].min[axis]);
    }
    const std::size_t count =
        std::min(tuning().sweep.max_buckets, std::bit_ceil(std::max<std::size_t>(list.size(), 2)));
    Buckets buckets;
    buckets.begin = first;
    buckets.last = std::uint32_t(count - 1);
    const double extent = double(last) - double(first);
    buckets.scale = extent > 0 ? float(std::min(double(count) / extent, double(FLT_MAX))) : 0.0f;
    return buckets;
}

std::uint64_t SweepOrder::tests(const EntryList& rows, const EntryList& columns, unsigned axis) {
    throw_if_stopped(stop_);
    const Sample column_sample = measured(columns), row_sample = measured(rows);
    lows_.resize(column_sample.size());
    for (std::size_t i = 0; i < lows_.size(); ++i) lows_[i] = columns[column_sample[i]].min[axis];
    std::sort(lows_.begin(), lows_.end());
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < row_sample.size(); ++i) {
        const Entry& row = rows[row_sample[i]];
        const auto first = std::lower_bound(lows_.begin(), lows_.end(), row.min[axis]);
        sum += std::uint64_t(std::upper_bound(first, lows_.end(), row.max[axis]) - first);
    }
    return sum * column_sample.stride() * row_sample.stride();
}

std::span<const SortKey> SweepOrder::sort(const EntryList& list, unsigned axis, Executor& executor) {
    if (list.size() <= tuning().sweep.max_bucket_sort) {
        sort_in_cache(list, axis);
    } else {
        count_path(Path::sort_radix);
        make_keys(list, axis);
        radix_sort(keys_, executor, stop_);
    }
    return keys_.span();
}

void SweepOrder::make_keys(const EntryList& list, unsigned axis) {
    keys_.resize_discard(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) keys_[i] = sort_key(list[i].min[axis], list.position(i));
}

/// Bucket sort: scatters keys by a prefix sum over buckets. The insertion sort that follows finds almost all keys in place.
/// If a bucket is crowded, sorts by comparison instead.
void SweepOrder::sort_in_cache(const EntryList& list, unsigned axis) {
    make_keys(list, axis);
    if (list.size() <= tuning().sweep.max_comparison_sort) {
        count_path(Path::sort_few);
        return std::sort(keys_.data(), keys_.data() + keys_.size());
    }
    const Buckets buckets = buckets_for(list, axis);
    counts_.assign(buckets.last + 2, 0);
    buckets_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) ++counts_[(buckets_[i] = buckets.of(list[i].min[axis])) + 1];
    std::uint32_t most = 0;
    for (std::size_t i = 1; i < counts_.size(); ++i) {
        most = std::max(most, counts_[i]);
        counts_[i] += counts_[i - 1];
    }
    if (most > tuning().sweep.max_comparison_sort) {
        count_path(Path::sort_full_bucket);
        return std::sort(keys_.data(), keys_.data() + keys_.size());
    }
    count_path(Path::sort_buckets);
    scratch_.resize_discard(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) scratch_[counts_[buckets_[i]]++] = keys_[i];
    std::swap(keys_, scratch_);
    for (std::size_t i = 1; i < keys_.size(); ++i) {
        const SortKey key = keys_[i];
        std::size_t at = i;
        for (; at > 0 && keys_[at - 1] > key; --at) keys_[at] = keys_[at - 1];
        keys_[at] = key;
    }
}

std::uint64_t estimated_hits(const EntryList& rows, const EntryList& columns, const std::stop_token& stop) {
    const Sample row_sample(rows.size(), 1, tuning().sweep.tried_rows), column_sample = measured(columns);
    std::uint64_t hits = 0;
    for (std::size_t r = 0; r < row_sample.size(); ++r) {
        throw_if_stopped(stop);
        const Entry& row = rows[row_sample[r]];
        for (std::size_t i = 0; i < column_sample.size(); ++i) {
            hits += overlap(row, columns[column_sample[i]]) ? 1 : 0;
        }
        if (r == 3 && hits <= 4) {
            count_path(Path::hits_few);
            return 0;  // at most one hit for each row so far: few in any case
        }
    }
    return hits * row_sample.stride() * column_sample.stride();
}

}  // namespace octopair
