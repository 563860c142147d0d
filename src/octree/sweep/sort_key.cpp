#include "octree/sweep/sort_key.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

/// Sorts by one digit, from keys to sorted. Returns false, with nothing done, if all keys have the same digit.
bool sort_by_digit(std::span<const SortKey> keys, std::span<SortKey> sorted, unsigned shift, Executor& executor) {
    const std::size_t digits = std::size_t(1) << tuning().sweep.radix_digit_bits;
    const std::size_t blocks = std::clamp<std::size_t>(keys.size() / tuning().sweep.radix_block, 1, executor.width());
    if (blocks > 1) count_path(Path::radix_blocks);
    // For each block and digit: first the number of keys, then where the next key goes.
    std::vector<std::size_t> places(blocks * digits);
    const auto digit_of = [shift, mask = digits - 1](SortKey key) { return std::size_t(key >> shift) & mask; };
    const auto block = [&](std::size_t i) {
        const std::size_t begin = keys.size() * i / blocks;
        return keys.subspan(begin, keys.size() * (i + 1) / blocks - begin);
    };
    const auto places_of = [&](std::size_t i) { return std::span(places).subspan(i * digits, digits); };
    // The two loops over keys use local copies. Captured variables would be loaded again after each write to `places`: 6 to 8%
    // of the whole time of sheets and rods, 1 million objects.
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

}  // namespace octopair
