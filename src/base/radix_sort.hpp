// RadixSort: sorts integers by a range of their bits.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "base/memory.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

/// The sorter keeps its memory for later calls.
template <typename Key>
class RadixSort {
public:
    /// Returns an array of `size` keys, to be filled by the caller.
    std::span<Key> take(std::size_t size) {
        keys_.resize_discard(size);
        return keys_.span();
    }

    /// Sorts the array of the last take() and returns it.
    /// Requires: all keys have the same bits from `end_bit` on, and are already in the order of the bits below `first_bit`.
    std::span<const Key> sort(unsigned first_bit, unsigned end_bit) {
        if (keys_.size() < tuning().output.min_radix_sort) {
            std::sort(keys_.span().begin(), keys_.span().end());
            return keys_.span();
        }
        count_path(Path::radix_sorted);
        other_.resize_discard(keys_.size());
        for (unsigned shift = first_bit; shift < end_bit; shift += digit_bits) {
            pass(shift);
            std::swap(keys_, other_);
        }
        return keys_.span();
    }

private:
    static constexpr unsigned digit_bits = 11;

    void pass(unsigned shift) {
        constexpr Key digit_mask = (Key(1) << digit_bits) - 1;
        std::array<std::uint32_t, (1u << digit_bits) + 1> at{};
        for (const Key key : keys_.span()) ++at[(key >> shift & digit_mask) + 1];
        for (std::size_t i = 1; i < at.size(); ++i) at[i] += at[i - 1];
        for (const Key key : keys_.span()) other_[at[key >> shift & digit_mask]++] = key;
    }

    Buffer<Key> keys_, other_;
};

}  // namespace octopair
