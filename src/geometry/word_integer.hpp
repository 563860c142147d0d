// WordInteger: integers of a fixed number of 64-bit words, for exact sums and products of float64 numbers (dyadic_grid.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/dyadic_grid.hpp"

namespace octopair {

/// An integer modulo 2^(64 * words), least word first. Negative numbers are two's complements.
template <std::size_t words>
class WordInteger {
    __extension__ using DoubleWord = unsigned __int128;

public:
    WordInteger() = default;
    /// Makes `number` in multiples of 2^unit. Requires: unit <= number.exponent.
    WordInteger(const Dyadic& number, int unit) {
        if (number.mantissa == 0) return;
        const auto shift = unsigned(number.exponent - unit);
        std::size_t word = shift / 64;
        const unsigned bits = shift % 64;
        const auto sign = std::uint64_t(number.mantissa >> 63);
        words_[word] = std::uint64_t(number.mantissa) << bits;
        if (++word < words) words_[word] = bits == 0 ? sign : std::uint64_t(number.mantissa >> (64 - bits));
        while (++word < words) words_[word] = sign;
    }

    void subtract(const WordInteger& other) {
        bool borrow = false;
        for (std::size_t i = 0; i < words; ++i) {
            const std::uint64_t before = words_[i], less = other.words_[i];
            words_[i] = before - less - (borrow ? 1 : 0);
            borrow = before < less || (borrow && before == less);
        }
    }

    void add_product(const WordInteger& a, const WordInteger& b) {
        for (std::size_t i = 0; i < words; ++i) {
            if (a.words_[i] == 0) continue;
            std::uint64_t carry = 0;
            for (std::size_t j = 0; i + j < words; ++j) {
                const DoubleWord sum = DoubleWord(a.words_[i]) * b.words_[j] + words_[i + j] + carry;
                words_[i + j] = std::uint64_t(sum);
                carry = std::uint64_t(sum >> 64);
            }
        }
    }

    /// Compares numbers that are not negative.
    int compare(const WordInteger& other) const {
        for (std::size_t i = words; i-- > 0;) {
            if (words_[i] != other.words_[i]) return words_[i] < other.words_[i] ? -1 : 1;
        }
        return 0;
    }

    int sign() const {
        if (words_[words - 1] >> 63 != 0) return -1;
        return compare({}) > 0 ? 1 : 0;
    }

private:
    std::array<std::uint64_t, words> words_{};
};

}  // namespace octopair
