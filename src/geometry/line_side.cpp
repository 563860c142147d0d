// Signs that float64 cannot decide, computed with integers, in the fewest words that hold the determinant. Most meshes have
// coordinates of 12 to 24 bits, so two words suffice.
#include "geometry/line_side.hpp"

#include <array>
#include <cstddef>

#include "geometry/word_integer.hpp"

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

}  // namespace octopair
