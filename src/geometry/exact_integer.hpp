// Exact integer arithmetic with float64 numbers.
//
// - Each finite float64 is an integer times a power of two (Dyadic). In units of the least such power, all numbers of a computation are
//   integers; their width depends on the spread of the exponents (DyadicGrid).
// - WordInteger: integers of a fixed number of 64-bit words, for exact sums and products of such numbers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace octopair {

/// The number mantissa * 2^exponent. The mantissa is odd, or 0.
struct Dyadic {
    std::int64_t mantissa = 0;
    int exponent = 0;

    explicit Dyadic(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        auto magnitude = bits & ((std::uint64_t(1) << 52) - 1);
        const int biased = int(bits >> 52 & 0x7FF);
        if (biased != 0) magnitude |= std::uint64_t(1) << 52;
        if (magnitude == 0) return;
        const int zeros = std::countr_zero(magnitude);
        mantissa = std::int64_t(magnitude >> zeros);
        if (bits >> 63 != 0) mantissa = -mantissa;
        exponent = std::max(biased, 1) - 1075 + zeros;
    }

    /// Returns an exponent e such that the magnitude is below 2^e.
    int end() const { return exponent + int(std::bit_width(std::uint64_t(mantissa < 0 ? -mantissa : mantissa))); }
};

/// Numbers as integer multiples of their common unit, the least power of two among them.
template <std::size_t count>
class DyadicGrid {
public:
    explicit DyadicGrid(const std::array<double, count>& values)
        : numbers_(make(values, std::make_index_sequence<count>())) {
        int begin = 0, end = 0;
        bool any = false;
        for (const Dyadic& number : numbers_) {
            if (number.mantissa == 0) continue;
            begin = any ? std::min(begin, number.exponent) : number.exponent;
            end = any ? std::max(end, number.end()) : number.end();
            any = true;
        }
        begin_ = begin;
        bits_ = unsigned(end - begin);
    }

    /// Returns a bound: all integers have magnitudes below 2^bits.
    unsigned bits() const { return bits_; }
    /// Returns the exponent of the unit: each number is an integer times 2^unit.
    int unit() const { return begin_; }
    const Dyadic& number(std::size_t i) const { return numbers_[i]; }

    /// Returns number `i` as an integer. Requires: Integer has more than bits() bits.
    template <typename Integer>
    Integer at(std::size_t i) const {
        if (numbers_[i].mantissa == 0) return Integer(0);
        return Integer(numbers_[i].mantissa) << unsigned(numbers_[i].exponent - begin_);
    }

private:
    template <std::size_t... i>
    static std::array<Dyadic, count> make(const std::array<double, count>& values, std::index_sequence<i...> /*of*/) {
        return {Dyadic(values[i])...};
    }

    std::array<Dyadic, count> numbers_;
    int begin_ = 0;
    unsigned bits_ = 0;
};

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
