// Computes signs that float64 cannot decide, with integers of the fewest words that hold the determinant. Most meshes have
// coordinates of 12 to 24 bits, so two words suffice.
#include "geometry/exact_sign.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "geometry/exact_integer.hpp"

namespace octopair {
namespace {

/// Returns the sign of the determinant of the rows b - a, c - a. The grid holds the rows a, b, c.
template <std::size_t words>
int line_sign(const DyadicGrid<6>& grid) {
    const auto difference = [&](std::size_t from, std::size_t less) {
        WordInteger<words> number(grid.number(from), grid.unit());
        number.subtract(WordInteger<words>(grid.number(less), grid.unit()));
        return number;
    };
    WordInteger<words> left, right;
    left.add_product(difference(2, 0), difference(5, 1));
    right.add_product(difference(3, 1), difference(4, 0));
    left.subtract(right);
    return left.sign();
}

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

int exact_line_side(const Point3d& a, const Point3d& b, const Point3d& c, unsigned axis) {
    const unsigned u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
    for (const unsigned across : {u, v}) {
        if (a[across] == b[across] && a[across] == c[across]) return 0;
    }
    const DyadicGrid<6> grid({a[u], a[v], b[u], b[v], c[u], c[v]});
    // The difference of products of two differences: 2 * (bits + 1) + 1 bits, and a sign.
    if (grid.bits() <= 62) return line_sign<2>(grid);
    if (grid.bits() <= 126) return line_sign<4>(grid);
    if (grid.bits() <= 254) return line_sign<8>(grid);
    return line_sign<66>(grid);  // at most 1024 + 1074 bits
}

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
