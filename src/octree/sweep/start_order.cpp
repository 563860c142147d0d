#include "octree/sweep/start_order.hpp"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/sweep/entry_list.hpp"

namespace octopair {

namespace {

/// Sorts `keys` by one digit into `sorted`. Returns false, and leaves `sorted` as it was, if all keys have the same digit.
bool sort_by_digit(std::span<const SortKey> keys, std::span<SortKey> sorted, unsigned shift, Executor& executor) {
    const std::size_t digits = std::size_t(1) << tuning().sweep.radix_digit_bits;
    const std::size_t blocks = std::clamp<std::size_t>(keys.size() / tuning().sweep.radix_block, 1, executor.width());
    if (blocks > 1) count_path(Path::radix_blocks);
    // For each block and digit: first the number of keys, later the place in `sorted` of the next key.
    std::vector<std::size_t> places(blocks * digits);
    const auto digit_of = [shift, mask = digits - 1](SortKey key) { return std::size_t(key >> shift) & mask; };
    const auto block = [&](std::size_t i) {
        const std::size_t begin = keys.size() * i / blocks;
        return keys.subspan(begin, keys.size() * (i + 1) / blocks - begin);
    };
    const auto places_of = [&](std::size_t i) { return std::span(places).subspan(i * digits, digits); };
    // The two loops over keys use local copies, because the compiler reloads captured variables after each write to `places`. The reloads
    // took 6 to 8% of the whole time on the scenes sheets and rods with 1 million objects.
    executor.for_each(blocks, [&](std::size_t i) {
        const auto digit = digit_of;
        const std::span<std::size_t> counts = places_of(i);
        for (const SortKey key : block(i)) ++counts[digit(key)];
    });
    std::size_t at = 0;
    for (std::size_t digit = 0; digit < digits; ++digit) {
        const std::size_t before = at;
        for (std::size_t i = 0; i < blocks; ++i) at += std::exchange(places[i * digits + digit], at);
        if (at - before == keys.size()) return false;
    }
    executor.for_each(blocks, [&](std::size_t i) {
        const auto digit = digit_of;
        const std::span<SortKey> to = sorted;
        const std::span<std::size_t> next = places_of(i);
        for (const SortKey key : block(i)) to[next[digit(key)]++] = key;
    });
    return true;
}

}  // namespace

void radix_sort(Buffer<SortKey>& keys, Executor& executor, const std::stop_token& stop) {
    Buffer<SortKey> scratch(keys.size());
    for (unsigned shift = 32; shift < 64; shift += tuning().sweep.radix_digit_bits) {
        throw_if_stopped(stop);
        if (sort_by_digit(keys.span(), scratch.span(), shift, executor)) std::swap(keys, scratch);
    }
}

StartOrder::Buckets StartOrder::buckets_for_keys() const {
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

std::span<const SortKey> StartOrder::sort(const EntryList& list, unsigned axis, Executor& executor) {
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

void StartOrder::make_keys(const EntryList& list, unsigned axis) {
    keys_.resize_discard(list.size());
    SortKey* key = keys_.data();
    list.for_each([&](std::uint32_t position, const Entry& entry) { *key++ = sort_key(entry.min[axis], position); });
}

/// Bucket sort: scatters keys by a prefix sum over buckets. The insertion sort that follows finds almost all keys in place.
/// If a bucket is crowded, sorts by comparison instead.
void StartOrder::sort_in_cache() {
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
