// Exact integer arithmetic: all numbers become integer multiples of the least power of two among them (dyadic_grid.hpp). Most
// coordinates span few binary digits, so that two or four 64-bit words hold the sum. The widest type holds any float64.
#include "geometry/square_sum.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "geometry/word_integer.hpp"

namespace octopair {
namespace {

struct Difference {
    Dyadic high{0}, low{0};
};
using Differences = std::array<Difference, 3>;

template <std::size_t words>
WordInteger<words> square_sum(const Differences& differences, int unit) {
    WordInteger<words> sum;
    for (const auto& [high, low] : differences) {
        if (high.mantissa == 0 && low.mantissa == 0) continue;
        WordInteger<words> gap(high, unit);
        gap.subtract(WordInteger<words>(low, unit));
        sum.add_product(gap, gap);
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
