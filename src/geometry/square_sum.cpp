// Exact integer arithmetic: all numbers become integer multiples of the least power of two among them (dyadic_grid.hpp). Most
// coordinates span few binary digits, so that two or four 64-bit words hold the sum. The widest type holds any float64.
#include "geometry/square_sum.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "geometry/dyadic_grid.hpp"

namespace octopair {
namespace {

__extension__ using DoubleWord = unsigned __int128;

struct Difference {
    Dyadic high{0}, low{0};
};
using Differences = std::array<Difference, 3>;

/// An integer modulo 2^(64 * words), least word first.
template <std::size_t words>
class WordInteger {
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

    void add_square(const WordInteger& root) {
        for (std::size_t i = 0; i < words; ++i) {
            if (root.words_[i] == 0) continue;
            std::uint64_t carry = 0;
            for (std::size_t j = 0; i + j < words; ++j) {
                const DoubleWord sum = DoubleWord(root.words_[i]) * root.words_[j] + words_[i + j] + carry;
                words_[i + j] = std::uint64_t(sum);
                carry = std::uint64_t(sum >> 64);
            }
        }
    }

    int compare(const WordInteger& other) const {
        for (std::size_t i = words; i-- > 0;) {
            if (words_[i] != other.words_[i]) return words_[i] < other.words_[i] ? -1 : 1;
        }
        return 0;
    }

private:
    std::array<std::uint64_t, words> words_{};
};

template <std::size_t words>
WordInteger<words> square_sum(const Differences& differences, int unit) {
    WordInteger<words> sum;
    for (const auto& [high, low] : differences) {
        if (high.mantissa == 0 && low.mantissa == 0) continue;
        WordInteger<words> gap(high, unit);
        gap.subtract(WordInteger<words>(low, unit));
        sum.add_square(gap);
    }
    return sum;
}

template <std::size_t words>
int compare_in(const Differences& a, const Differences& b, int unit) {
    return square_sum<words>(a, unit).compare(square_sum<words>(b, unit));
}

int compare(const Differences& a, const Differences& b) {
    int unit = 0, end = 0;
    bool any = false;
    for (const Differences* differences : {&a, &b}) {
        for (const auto& [high, low] : *differences) {
            for (const Dyadic* number : {&high, &low}) {
                if (number->mantissa == 0) continue;
                unit = any ? std::min(unit, number->exponent) : number->exponent;
                end = any ? std::max(end, number->end()) : number->end();
                any = true;
            }
        }
    }
    // A difference of numbers below 2^bits is below 2^(bits + 1); the sum of three squares is below 2^(2 * (bits + 1) + 2).
    const int bits = end - unit;
    if (bits <= 62) return compare_in<2>(a, b, unit);
    if (bits <= 126) return compare_in<4>(a, b, unit);
    if (bits <= 254) return compare_in<8>(a, b, unit);
    return compare_in<66>(a, b, unit);  // at most 1025 + 1075 bits: from 2^-1075, half of the least float64, to 2^1025
}

Differences differences_of(const Gaps& gaps) {
    Differences differences;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (gaps[axis].high != gaps[axis].low) differences[axis] = {Dyadic(gaps[axis].high), Dyadic(gaps[axis].low)};
    }
    return differences;
}

}  // namespace

int compare_square_sums(const Gaps& a, const Gaps& b) { return compare(differences_of(a), differences_of(b)); }

int compare_root_with_middle(const Gaps& gaps, double low) {
    // After the largest float64, the incremented bits are those of infinity; Dyadic interprets them as 2^1024.
    Dyadic half_low(-low), half_high(std::bit_cast<double>(std::bit_cast<std::uint64_t>(low) + 1));
    --half_low.exponent;
    --half_high.exponent;
    Differences middle;
    middle[0] = {half_high, half_low};
    return compare(differences_of(gaps), middle);
}

}  // namespace octopair
