#include "narrow_phase/exact_oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <set>

namespace octopair::test {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Place = std::array<Rational, 3>;
/// Corners of a convex set, in order. One corner is a point, two corners are a segment.
using Convex = std::vector<Place>;

Place exactly(const Point3d& point) { return {Rational(point[0]), Rational(point[1]), Rational(point[2])}; }
Place operator-(const Place& a, const Place& b) {
    return {Rational(a[0] - b[0]), Rational(a[1] - b[1]), Rational(a[2] - b[2])};
}
Rational dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Place cross(const Place& a, const Place& b) {
    return {Rational(a[1] * b[2] - a[2] * b[1]), Rational(a[2] * b[0] - a[0] * b[2]),
            Rational(a[0] * b[1] - a[1] * b[0])};
}
bool is_zero(const Place& a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; }

/// The half space of all x with normal * (x - place) >= 0.
struct HalfSpace {
    Place place, normal;
    Rational height(const Place& x) const { return dot(normal, x - place); }
};

Convex cut(const Convex& whole, const HalfSpace& half) {
    Convex left;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const Place &from = whole[i], &to = whole[(i + 1) % whole.size()];
        const Rational begin = half.height(from), end = half.height(to);
        if (begin >= 0) left.push_back(from);
        if ((begin > 0 && end < 0) || (begin < 0 && end > 0)) {
            const Rational part = begin / (begin - end);
            const Place way = to - from;
            left.push_back({Rational(from[0] + part * way[0]), Rational(from[1] + part * way[1]),
                            Rational(from[2] + part * way[2])});
        }
    }
    return left;
}

void add_plane(std::vector<HalfSpace>& to, const Place& place, const Place& normal) {
    to.push_back({place, normal});
    to.push_back({place, Place{} - normal});
}

/// Returns the half spaces whose intersection is a segment or a point.
std::vector<HalfSpace> halves_of(const Place& begin, const Place& end) {
    std::vector<HalfSpace> halves;
    const Place way = end - begin;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Place unit;
        unit[axis] = 1;
        const Place normal = is_zero(way) ? unit : cross(way, unit);
        if (!is_zero(normal)) add_plane(halves, begin, normal);
    }
    halves.push_back({begin, way});
    halves.push_back({end, begin - end});
    return halves;
}

std::vector<HalfSpace> halves_of(const Triangle3d& triangle) {
    const std::array<Place, 3> at = {exactly(triangle[0]), exactly(triangle[1]), exactly(triangle[2])};
    const Place normal = cross(at[1] - at[0], at[2] - at[0]);
    if (is_zero(normal)) {
        const auto [low, high] = std::minmax_element(triangle.begin(), triangle.end());
        return halves_of(exactly(*low), exactly(*high));
    }
    std::vector<HalfSpace> halves;
    add_plane(halves, at[0], normal);
    for (std::size_t i = 0; i < 3; ++i) halves.push_back({at[i], cross(normal, at[(i + 1) % 3] - at[i])});
    return halves;
}

Convex common_corners(const Triangle3d& a, const Triangle3d& b) {
    Convex common = {exactly(a[0]), exactly(a[1]), exactly(a[2])};
    for (const HalfSpace& half : halves_of(b)) common = cut(common, half);
    return common;
}

bool is_within(const Place& place, const std::vector<HalfSpace>& halves) {
    return std::all_of(halves.begin(), halves.end(), [&](const HalfSpace& half) { return half.height(place) >= 0; });
}

std::vector<Point3d> shared_corners(const Triangle3d& a, const Triangle3d& b) {
    const std::set<Point3d> of_a(a.begin(), a.end()), of_b(b.begin(), b.end());
    std::vector<Point3d> shared;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(shared));
    return shared;
}

}  // namespace

int oracle_plane_side(const std::array<Point3d, 4>& corners) {
    const Place a = exactly(corners[0]);
    return dot(cross(exactly(corners[1]) - a, exactly(corners[2]) - a), exactly(corners[3]) - a).sign();
}

bool oracle_meet(const Triangle3d& a, const Triangle3d& b) { return !common_corners(a, b).empty(); }

unsigned oracle_shared_corners(const Triangle3d& a, const Triangle3d& b) {
    return unsigned(shared_corners(a, b).size());
}

bool oracle_meet_beyond(const Triangle3d& a, const Triangle3d& b) {
    const Convex common = common_corners(a, b);
    const std::vector<Point3d> shared = shared_corners(a, b);
    if (shared.empty()) return !common.empty();
    if (shared.size() == 3) return !is_zero(cross(exactly(a[1]) - exactly(a[0]), exactly(a[2]) - exactly(a[0])));
    const auto halves = halves_of(exactly(shared.front()), exactly(shared.back()));
    return !std::all_of(common.begin(), common.end(), [&](const Place& place) { return is_within(place, halves); });
}

OracleContact oracle_contact(const Triangle3d& a, const Triangle3d& b) {
    const Convex common = common_corners(a, b);
    const std::set<Place> corners(common.begin(), common.end());
    OracleContact contact = {corners.size(), false, !common.empty()};
    Place middle;
    for (const Place& corner : common) {
        contact.area |= !is_zero(cross(common[1 % common.size()] - common[0], corner - common[0]));
        for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += corner[axis] / int(common.size());
    }
    for (const Triangle3d& triangle : {a, b}) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto edge = halves_of(exactly(triangle[i]), exactly(triangle[(i + 1) % 3]));
            contact.inside &= !common.empty() && !is_within(middle, edge);
        }
    }
    return contact;
}

namespace {

Point3d grid_point(unsigned most, std::mt19937& random) {
    std::uniform_int_distribution<int> at(0, int(most));
    return {double(at(random)), double(at(random)), double(at(random))};
}

TrianglePair grid_pair(unsigned most, std::mt19937& random) {
    TrianglePair pair;
    for (auto& triangle : pair) {
        for (Point3d& corner : triangle) corner = grid_point(most, random);
    }
    return pair;
}

/// Returns triangles with corners drawn from a few places. Most corners are shared, and some triangles have a
/// corner twice.
TrianglePair neighbours(unsigned places, std::mt19937& random) {
    std::vector<Point3d> from(places);
    for (Point3d& place : from) place = grid_point(3, random);
    TrianglePair pair;
    for (auto& triangle : pair) {
        for (Point3d& corner : triangle) corner = from[random() % places];
    }
    return pair;
}

/// Returns triangles whose corners are rounded combinations of three places: coplanar except for rounding errors.
TrianglePair almost_coplanar(std::mt19937& random) {
    std::uniform_real_distribution<double> at(-1, 1);
    std::array<Point3d, 3> base;
    for (Point3d& place : base) place = {at(random), at(random), at(random)};
    TrianglePair pair;
    for (auto& triangle : pair) {
        for (Point3d& corner : triangle) {
            const double u = double(random() % 5) / 4, v = double(random() % 5) / 4;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                corner[axis] =
                    base[0][axis] + (u * (base[1][axis] - base[0][axis]) + v * (base[2][axis] - base[0][axis]));
            }
        }
    }
    return pair;
}

void transform(TrianglePair& pair, const Point3d& scale, const Point3d& move) {
    for (auto& triangle : pair) {
        for (Point3d& corner : triangle) {
            for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] = corner[axis] * scale[axis] + move[axis];
        }
    }
}

}  // namespace

TrianglePair some_pair(unsigned kind, std::mt19937& random) {
    std::uniform_real_distribution<double> at(-1, 1);
    TrianglePair pair = kind == 0   ? grid_pair(2, random)
                        : kind == 1 ? neighbours(5, random)
                        : kind == 2 ? almost_coplanar(random)
                                    : grid_pair(random() % 2 == 0 ? 3 : 8, random);
    switch (kind) {
        case 3: {
            for (auto& triangle : pair) {
                for (Point3d& corner : triangle) corner = {at(random), at(random), at(random)};
            }
            break;
        }
        case 4:
            transform(pair, {1e6, 1e6, 1e6}, {1e6 / 3, 1e6 / 7, 0});
            break;
        case 5:
            transform(pair, {1e-300, 1e-300, 3e-320}, {0, 0, 0});
            break;
        case 6:
            transform(pair, {1e300, 1e307, 1e300}, {-1e300, 0, 1});
            break;
        case 7:
            transform(pair, {1, 1e-200, 1e200}, {0, 0, 0});
            break;
        default:
            break;
    }
    return pair;
}

std::string text(const TrianglePair& pair) { return ::testing::PrintToString(pair); }

}  // namespace octopair::test
