#include "octree/sweep/sweep_order.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

SweepOrder::Buckets SweepOrder::buckets_for_keys() const {
    const auto [least, greatest] = std::ranges::minmax(keys_.span());
    const float first = low_of(least), last = low_of(greatest);
    const std::size_t count =
        std::min(tuning().sweep.max_buckets, std::bit_ceil(std::max<std::size_t>(keys_.size(), 2)));
    Buckets buckets;
    buckets.begin = first;
    buckets.last = std::uint32_t(count - 1);
    const double extent = double(last) - double(first);
    buckets.scale = extent > 0 ? float(std::min(double(count) / extent, double(FLT_MAX))) : 0.0f;
    return buckets;
}

std::span<const SortKey> SweepOrder::sort(const EntryList& list, unsigned axis, Executor& executor) {
    throw_if_stopped(stop_);
    make_keys(list, axis);
    if (list.size() <= tuning().sweep.max_bucket_sort) {
        sort_in_cache();
    } else {
        count_path(Path::sort_radix);
        radix_sort(keys_, executor, stop_);
    }
    return keys_.span();
}

void SweepOrder::make_keys(const EntryList& list, unsigned axis) {
    keys_.resize_discard(list.size());
    SortKey* key = keys_.data();
    list.for_each([&](std::uint32_t position, const Entry& entry) { *key++ = sort_key(entry.min[axis], position); });
}

/// Bucket sort: scatters keys by a prefix sum over buckets. The insertion sort that follows finds almost all keys in place.
/// If a bucket is crowded, sorts by comparison instead.
void SweepOrder::sort_in_cache() {
    if (keys_.size() <= tuning().sweep.max_comparison_sort) {
        count_path(Path::sort_few);
        return std::sort(keys_.data(), keys_.data() + keys_.size());
    }
    const Buckets buckets = buckets_for_keys();
    counts_.assign(buckets.last + 2, 0);
    buckets_.resize(keys_.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) ++counts_[(buckets_[i] = buckets.of(low_of(keys_[i]))) + 1];
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
    scratch_.resize_discard(keys_.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) scratch_[counts_[buckets_[i]]++] = keys_[i];
    std::swap(keys_, scratch_);
    for (std::size_t i = 1; i < keys_.size(); ++i) {
        const SortKey key = keys_[i];
        std::size_t at = i;
        for (; at > 0 && keys_[at - 1] > key; --at) keys_[at] = keys_[at - 1];
        keys_[at] = key;
    }
}

}  // namespace octopair
