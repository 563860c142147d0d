#include "octree/sort_key.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

namespace {

constexpr unsigned digit_bits = 11;
constexpr std::size_t digits = std::size_t(1) << digit_bits;

/// Of a block of keys: first how many there are of each digit, then where the next one goes.
using Places = std::array<std::size_t, digits>;

/// One digit, from keys to sorted; false, with nothing done, if it is the same in all.
bool pass(std::span<const SortKey> keys, std::span<SortKey> sorted, unsigned shift, Executor& executor) {
    std::vector<Places> blocks(std::clamp<std::size_t>(keys.size() / tuning().sweep.radix_block, 1, executor.width()));
    if (blocks.size() > 1) count_path(Path::radix_blocks);
    const auto digit_of = [&](SortKey key) { return std::size_t(key >> shift) & (digits - 1); };
    const auto block = [&](std::size_t i) {
        const std::size_t begin = keys.size() * i / blocks.size();
        return keys.subspan(begin, keys.size() * (i + 1) / blocks.size() - begin);
    };
    executor.for_each(blocks.size(), [&](std::size_t i) {
        blocks[i].fill(0);
        for (const SortKey key : block(i)) ++blocks[i][digit_of(key)];
    });
    std::size_t at = 0;
    for (std::size_t digit = 0; digit < digits; ++digit) {
        const std::size_t before = at;
        for (Places& places : blocks) at += std::exchange(places[digit], at);
        if (at - before == keys.size()) return false;
    }
    executor.for_each(blocks.size(), [&](std::size_t i) {
        for (const SortKey key : block(i)) sorted[blocks[i][digit_of(key)]++] = key;
    });
    return true;
}

}  // namespace

void radix_sort(Buffer<SortKey>& keys, Executor& executor, const std::stop_token& stop) {
    Buffer<SortKey> scratch(keys.size());
    for (unsigned shift = 32; shift < 64; shift += digit_bits) {
        throw_if_stopped(stop);
        if (pass(keys.span(), scratch.span(), shift, executor)) std::swap(keys, scratch);
    }
}

}  // namespace octopair
