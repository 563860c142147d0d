#include "octree/sweep_order.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>

#include "base/stop.hpp"

namespace octopair {

namespace {

constexpr std::size_t cached_buckets = 4096;  // for sets whose buckets should stay in the first cache
constexpr std::size_t bucket_boxes = 4;       // in larger sets: fewer buckets would make windows look wide
constexpr std::size_t few = 24;               // sets this small are sorted by comparison at once
constexpr std::size_t in_cache = 1 << 14;     // up to here one thread's bucket sort is best
constexpr std::size_t sampled_rows = 16;

}  // namespace

SweepOrder::Buckets SweepOrder::buckets_for(const EntryList& list, unsigned axis) {
    float first = FLT_MAX;
    float last = -FLT_MAX;
    for (std::size_t i = 0; i < list.size(); ++i) {
        first = std::min(first, list[i].min[axis]);
        last = std::max(last, list[i].min[axis]);
    }
    const std::size_t least = std::min(cached_buckets, std::bit_ceil(std::max<std::size_t>(list.size(), 2)));
    const std::size_t count = std::max(least, std::bit_floor(list.size() / bucket_boxes));
    Buckets buckets;
    buckets.begin = first;
    buckets.last = std::uint32_t(count - 1);
    const double extent = double(last) - double(first);
    buckets.scale = extent > 0 ? float(std::min(double(count) / extent, double(FLT_MAX))) : 0.0f;
    return buckets;
}

std::uint64_t SweepOrder::windows(const EntryList& rows, const EntryList& columns, unsigned axis) {
    if (rows.size() == 0 || columns.size() == 0) return 0;
    throw_if_stopped(stop_);
    const Buckets buckets = buckets_for(columns, axis);
    throw_if_stopped(stop_);
    counts_.assign(buckets.last + 2, 0);
    for (std::size_t i = 0; i < columns.size(); ++i) ++counts_[buckets.of(columns[i].min[axis]) + 1];
    for (std::size_t i = 1; i < counts_.size(); ++i) counts_[i] += counts_[i - 1];
    throw_if_stopped(stop_);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Entry& row = rows[i];
        if (row.max[axis] < buckets.begin) continue;
        sum += counts_[buckets.of(row.max[axis]) + 1] - counts_[buckets.of(row.min[axis])];
    }
    return sum;
}

std::span<const SortItem> SweepOrder::sort(const EntryList& list, unsigned axis, Executor& executor) {
    if (list.size() > few && list.size() <= in_cache) {
        small_sort(list, axis);
        return items_;
    }
    items_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        const Entry& entry = list[i];
        items_[i] = {entry.min[axis], entry.object, list.position(i)};
    }
    throw_if_stopped(stop_);
    executor.sort(items_);
    throw_if_stopped(stop_);
    return items_;
}

/// Bucket sort: places by a prefix sum over buckets, then each bucket by comparison.
void SweepOrder::small_sort(const EntryList& list, unsigned axis) {
    const Buckets buckets = buckets_for(list, axis);
    counts_.assign(buckets.last + 2, 0);
    for (std::size_t i = 0; i < list.size(); ++i) ++counts_[buckets.of(list[i].min[axis]) + 1];
    for (std::size_t i = 1; i < counts_.size(); ++i) counts_[i] += counts_[i - 1];
    items_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        const Entry& entry = list[i];
        items_[counts_[buckets.of(entry.min[axis])]++] = {entry.min[axis], entry.object, list.position(i)};
    }
    std::size_t begin = 0;  // counts_[b] is now where bucket b ends
    for (std::size_t bucket = 0; bucket <= buckets.last; ++bucket) {
        const std::size_t end = counts_[bucket];
        if (end - begin > 1) std::sort(items_.begin() + std::ptrdiff_t(begin), items_.begin() + std::ptrdiff_t(end));
        begin = end;
    }
}

std::uint64_t estimated_hits(const EntryList& rows, const EntryList& columns, const std::stop_token& stop) {
    const std::size_t samples = std::min(sampled_rows, rows.size());
    std::uint64_t hits = 0;
    for (std::size_t s = 0; s < samples; ++s) {
        throw_if_stopped(stop);
        const Entry& row = rows[s * rows.size() / samples];
        for (std::size_t i = 0; i < columns.size(); ++i) hits += overlap(row, columns[i]) ? 1 : 0;
        if (s == 3 && hits <= 4) return 0;  // no more than the rows themselves: certainly few
    }
    return samples == 0 ? 0 : hits * rows.size() / samples;
}

}  // namespace octopair
