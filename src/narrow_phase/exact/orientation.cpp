// Signs that float64 cannot decide, computed with integers, in the narrowest type that holds the determinant.
//
// Most meshes have coordinates of 12 to 24 bits; their determinants are below 2^127.
#include "narrow_phase/exact/orientation.hpp"

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>

#include "geometry/exact_integer.hpp"

namespace octopair {
namespace {

namespace mp = boost::multiprecision;
template <unsigned bits>
using Fixed = mp::number<mp::cpp_int_backend<bits, bits, mp::signed_magnitude, mp::unchecked, void>, mp::et_off>;
using Unbounded = mp::number<mp::cpp_int_backend<>, mp::et_off>;

/// Returns the sign of the determinant of the rows b - a, c - a, d - a. The grid holds the rows a, b, c, d.
template <typename Integer>
int plane_sign(const DyadicGrid<12>& grid) {
    std::array<Integer, 9> m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto origin = grid.at<Integer>(axis);
        for (std::size_t row = 0; row < 3; ++row) {
            m[3 * row + axis] = grid.at<Integer>(3 * row + 3 + axis) - origin;
        }
    }
    const Integer sum =
        m[6] * (m[1] * m[5] - m[2] * m[4]) + m[7] * (m[2] * m[3] - m[0] * m[5]) + m[8] * (m[0] * m[4] - m[1] * m[3]);
    return sum.sign();
}

}  // namespace

int exact_plane_side(const Point3d& a, const Point3d& b, const Point3d& c, const Point3d& d) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis]) return 0;
    }
    if (a == b || a == c || a == d || b == c || b == d || c == d) return 0;
    const DyadicGrid<12> grid({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]});
    // Six products of three differences: 3 * (bits + 1) + 3 bits.
    if (grid.bits() <= 40) return plane_sign<Fixed<128>>(grid);
    if (grid.bits() <= 83) return plane_sign<Fixed<256>>(grid);
    if (grid.bits() <= 168) return plane_sign<Fixed<512>>(grid);
    return plane_sign<Unbounded>(grid);
}

}  // namespace octopair
