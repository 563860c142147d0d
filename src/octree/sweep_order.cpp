#include "octree/sweep_order.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>

#include "base/stop.hpp"

namespace octopair {

namespace {

constexpr std::size_t cached_buckets = 4096;  // for sets whose buckets should stay in the first cache
constexpr std::size_t bucket_boxes = 4;       // in larger sets: fewer buckets would make windows look wide
constexpr std::size_t few = 24;               // boxes: so many at most are sorted by comparison
constexpr std::size_t sampled_rows = 16;
constexpr std::size_t sampled_stride = 13;  // rows

/// Bits that as integers are in the order of the numbers.
std::uint32_t ordered_bits(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return bits ^ (bits >> 31 != 0 ? ~0u : 0x80000000u);
}

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

void SweepOrder::lay_out(const EntryList& list, unsigned axis, SweepSet& set) {
    sort_keys(list, axis);
    positions_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) positions_[i] = std::uint32_t(keys_[i]);
    set.assign(list.entries, positions_, axis);
}

/// Bucket sort: places by a prefix sum over buckets, then an insertion sort, which finds almost all in place; where
/// some bucket is crowded, sorts by comparison.
void SweepOrder::sort_keys(const EntryList& list, unsigned axis) {
    const std::size_t size = list.size();
    const auto key_of = [&](std::size_t i) {
        return std::uint64_t(ordered_bits(list[i].min[axis])) << 32 | list.position(i);
    };
    keys_.resize(size);
    bool crowded = size <= few;
    if (!crowded) {
        const Buckets buckets = buckets_for(list, axis);
        counts_.assign(buckets.last + 2, 0);
        buckets_.resize(size);
        for (std::size_t i = 0; i < size; ++i) ++counts_[(buckets_[i] = buckets.of(list[i].min[axis])) + 1];
        std::uint32_t most = 0;
        for (std::size_t i = 1; i < counts_.size(); ++i) {
            most = std::max(most, counts_[i]);
            counts_[i] += counts_[i - 1];
        }
        for (std::size_t i = 0; i < size; ++i) keys_[counts_[buckets_[i]]++] = key_of(i);
        crowded = most > few;
    } else {
        for (std::size_t i = 0; i < size; ++i) keys_[i] = key_of(i);
    }
    if (crowded) {
        std::sort(keys_.begin(), keys_.end());
        return;
    }
    for (std::size_t i = 1; i < size; ++i) {
        const std::uint64_t key = keys_[i];
        std::size_t at = i;
        for (; at > 0 && keys_[at - 1] > key; --at) keys_[at] = keys_[at - 1];
        keys_[at] = key;
    }
}

std::uint64_t sampled_windows(const Sweep& sweep) {
    const auto& [rows, columns, kind] = sweep;
    const float* const lows = columns.low(0);
    const float* const end = lows + columns.size();
    std::uint64_t sum = 0;
    std::size_t samples = 0;
    for (std::size_t i = 0; i < rows.size(); i += sampled_stride, ++samples) {
        const float* const first = kind == SweepKind::self ? lows + i + 1 : std::lower_bound(lows, end, rows.low(0)[i]);
        sum += std::uint64_t(std::upper_bound(first, end, rows.high(0)[i]) - first);
    }
    return samples == 0 ? 0 : sum * rows.size() / samples;
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
