#include "narrow_phase/exact/triangle_pair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/plane_crossing.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {
namespace {

/// How far points are along a direction, from an origin. Every direction will do, so its own roundings do not matter; those
/// of the distances are at most four of the sum of their terms' sizes.
class Direction {
public:
    Direction(const Point3d& origin, const Point3d& direction) : origin_(origin), direction_(direction) {}

    double operator()(const Point3d& place) {
        const double x = direction_[0] * (place[0] - origin_[0]);
        const double y = direction_[1] * (place[1] - origin_[1]);
        const double z = direction_[2] * (place[2] - origin_[2]);
        sizes_ += std::abs(x) + std::abs(y) + std::abs(z);
        return x + y + z;
    }

    /// Whether a difference of two distances asked for is above 0 without doubt; never where one was not finite.
    bool clear(double difference) const { return difference > 0x1p-49 * sizes_ + filter::underflow; }

private:
    const Point3d& origin_;
    Point3d direction_;
    double sizes_ = 0;
};

/// True if float64 sees a plane across the line between their middles that separates them: what spares neighbours in a
/// flat part of a mesh all exact arithmetic.
bool clearly_apart(const Triangle3d& a, const Triangle3d& b) {
    Point3d between;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        between[axis] = (a[0][axis] + a[1][axis] + a[2][axis]) - (b[0][axis] + b[1][axis] + b[2][axis]);
    }
    Direction along(a[0], between);
    const double low = std::min(0.0, std::min(along(a[1]), along(a[2])));
    const double high = std::max(along(b[0]), std::max(along(b[1]), along(b[2])));
    return along.clear(low - high);
}

/// 0 where float64 does not know.
CornerSides rounded_sides(const PlaneSides& plane, const Triangle3d& triangle) {
    return {plane.rounded(triangle[0]), plane.rounded(triangle[1]), plane.rounded(triangle[2])};
}
bool are_sure(const CornerSides& sides) { return sides[0] != 0 && sides[1] != 0 && sides[2] != 0; }

/// Of triangles in one plane: some edge has the other triangle on its outer side.
bool edge_separates(const Triangle3d& a, const Facing& seen, const Triangle3d& b) {
    for (std::size_t i = 0; i < 3; ++i) {
        const auto outside = [&](const Point3d& corner) {
            return line_side(a[i], a[(i + 1) % 3], corner, seen.axis) * seen.side < 0;
        };
        if (std::all_of(b.begin(), b.end(), outside)) return true;
    }
    return false;
}

/// Of triangles that are degenerate or lie in one plane.
bool flat_triangles_meet(const Triangle3d& a, const Triangle3d& b) {
    const Facing a_seen = facing(a), b_seen = facing(b);
    if (a_seen.axis == 3) return segment_meets_triangle(hull_of_degenerate(a), b);
    if (b_seen.axis == 3) return segment_meets_triangle(hull_of_degenerate(b), a);
    return !edge_separates(a, a_seen, b) && !edge_separates(b, b_seen, a);
}

/// Triangles with one corner in common.
struct Fan {
    const Point3d& shared;
    std::array<const Point3d*, 2> a, b;
};

bool clearly_apart(const Fan& fan) {
    Point3d between;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        between[axis] = ((*fan.a[0])[axis] + (*fan.a[1])[axis]) - ((*fan.b[0])[axis] + (*fan.b[1])[axis]);
    }
    Direction along(fan.shared, between);
    const double low = std::min(along(*fan.a[0]), along(*fan.a[1]));
    const double high = std::max(along(*fan.b[0]), along(*fan.b[1]));
    return along.clear(std::min(low, -high));
}

/// A degenerate triangle is one or two segments from the shared corner.
std::array<Triangle3d, 2> parts_of(const Point3d& shared, const std::array<const Point3d*, 2>& others) {
    const Triangle3d whole = {shared, *others[0], *others[1]};
    if (!is_degenerate(whole)) return {whole, whole};
    return {Triangle3d{shared, *others[0], *others[0]}, Triangle3d{shared, *others[1], *others[1]}};
}

/// The slow way: a common point lies on rays from the shared corner, which leave the triangles through the edges
/// opposite to it; the nearer of the two is a common point as well.
bool flat_fan_meets_beyond(const Fan& fan) {
    const auto a_parts = parts_of(fan.shared, fan.a), b_parts = parts_of(fan.shared, fan.b);
    for (const Triangle3d& a : a_parts) {
        if (a[1] == fan.shared && a[2] == fan.shared) continue;
        for (const Triangle3d& b : b_parts) {
            if (b[1] == fan.shared && b[2] == fan.shared) continue;
            if (segment_meets_triangle({a[1], a[2]}, b) || segment_meets_triangle({b[1], b[2]}, a)) return true;
        }
    }
    return false;
}

/// Both planes pass through the shared corner, and so does their line. Each triangle that has not both other corners on
/// one side holds a part of it from the shared corner, which goes to the positive end if the first of these corners is
/// the higher one (plane_crossing.hpp has the directions); they meet beyond if both go to the same end.
bool fan_meets_beyond(const Fan& fan) {
    if (clearly_apart(fan)) return false;
    const PlaneSides b_plane(fan.shared, *fan.b[0], *fan.b[1]);
    const int a_first = b_plane(*fan.a[0]), a_second = b_plane(*fan.a[1]);
    if (a_first * a_second > 0) return false;
    const PlaneSides a_plane(fan.shared, *fan.a[0], *fan.a[1]);
    const int b_first = a_plane(*fan.b[0]), b_second = a_plane(*fan.b[1]);
    if (b_first * b_second > 0) return false;
    if (a_first == a_second || b_first == b_second) return flat_fan_meets_beyond(fan);
    return (a_first > a_second) != (b_first > b_second);
}

/// Triangles with an edge in common.
struct Hinge {
    const Point3d &begin, &end;
    const Point3d &a, &b;  ///< their third corners: no corners of the edge
};

/// Seen along some axis, the third corners are on different sides of the edge without doubt.
bool clearly_apart(const Hinge& hinge) {
    Point3d edge, a, b;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        edge[axis] = hinge.end[axis] - hinge.begin[axis];
        a[axis] = hinge.a[axis] - hinge.begin[axis];
        b[axis] = hinge.b[axis] - hinge.begin[axis];
    }
    bool apart = false;
    for (std::size_t u = 0; u < 3; ++u) {
        const std::size_t v = u == 2 ? 0 : u + 1;
        const auto side = [&](const Point3d& corner) {
            const double left = edge[u] * corner[v], right = edge[v] * corner[u];
            const double error = filter::line_error * (std::abs(left) + std::abs(right)) + filter::underflow;
            return filter::safe_sign(left - right, error);
        };
        apart |= side(a) * side(b) < 0;
    }
    return apart;
}

/// Only in one plane, folded onto each other; on one line, if both pass the same end of the edge.
bool hinge_meets_beyond(const Hinge& hinge) {
    if (clearly_apart(hinge)) return false;
    const auto& [begin, end, a, b] = hinge;
    if (plane_side(begin, end, a, b) != 0) return false;
    const Facing a_seen = facing({begin, end, a}), b_seen = facing({begin, end, b});
    if (a_seen.axis < 3 && b_seen.axis < 3) return line_side(begin, end, b, a_seen.axis) * a_seen.side > 0;
    if (a_seen.axis < 3 || b_seen.axis < 3) return false;
    const auto& [low, high] = std::minmax(begin, end);
    return (a < low && b < low) || (a > high && b > high);
}

/// Bit 3 * i + j: corner i of a is corner j of b.
unsigned equal_corners(const Triangle3d& a, const Triangle3d& b) {
    unsigned equal = 0;
    for (unsigned i = 0; i < 3; ++i) {
        for (unsigned j = 0; j < 3; ++j) equal |= unsigned(a[i][0] == b[j][0]) << (3 * i + j);
    }
    if (equal == 0) return 0;
    for (unsigned i = 0; i < 3; ++i) {
        for (unsigned j = 0; j < 3; ++j) {
            const bool same = a[i][1] == b[j][1] && a[i][2] == b[j][2];
            equal &= ~(unsigned(!same) << (3 * i + j));
        }
    }
    return equal;
}

/// Corners, each place once; the shared ones first.
struct DistinctCorners {
    std::array<const Point3d*, 3> at = {};
    unsigned count = 0, shared = 0;

    DistinctCorners(const Triangle3d& triangle, const Triangle3d& other) {
        for (const bool want_shared : {true, false}) {
            for (const Point3d& corner : triangle) {
                const bool is_shared = std::find(other.begin(), other.end(), corner) != other.end();
                const auto same = [&](const Point3d* known) { return *known == corner; };
                if (is_shared != want_shared || std::any_of(at.begin(), at.begin() + count, same)) continue;
                at[count++] = &corner;
            }
            if (want_shared) shared = count;
        }
    }
};

/// Of triangles that share corners, and may hold a place twice.
bool any_meet_beyond_shared(const Triangle3d& a, const Triangle3d& b) {
    const DistinctCorners of_a(a, b), of_b(b, a);
    if (of_a.shared == 3) return !is_degenerate(a);
    // What has no other corners is what they share.
    if (of_a.count == of_a.shared || of_b.count == of_b.shared) return false;
    if (of_a.shared == 2) return hinge_meets_beyond({*of_a.at[0], *of_a.at[1], *of_a.at[2], *of_b.at[2]});
    const auto last = [](const DistinctCorners& corners) { return corners.at[corners.count - 1]; };
    return fan_meets_beyond({*of_a.at[0], {of_a.at[1], last(of_a)}, {of_b.at[1], last(of_b)}});
}

}  // namespace

bool triangles_meet(const Triangle3d& a, const Triangle3d& b) {
    const PlaneSides b_plane(b);
    CornerSides a_sides = rounded_sides(b_plane, a);
    if (on_one_side(a_sides)) return false;
    const PlaneSides a_plane(a);
    CornerSides b_sides = rounded_sides(a_plane, b);
    if (on_one_side(b_sides)) return false;
    if (!are_sure(a_sides) || !are_sure(b_sides)) {
        if (clearly_apart(a, b)) return false;
        a_sides = corner_sides(b_plane, a);
        if (on_one_side(a_sides)) return false;
        b_sides = corner_sides(a_plane, b);
        if (on_one_side(b_sides)) return false;
        if (in_plane(a_sides) || in_plane(b_sides)) return flat_triangles_meet(a, b);
    }
    return PlaneCrossing(a, a_sides, b, b_sides).meet();
}

unsigned shared_corners(const Triangle3d& a, const Triangle3d& b) {
    return equal_corners(a, b) == 0 ? 0 : DistinctCorners(a, b).shared;
}

bool meet_beyond_shared(const Triangle3d& a, const Triangle3d& b) {
    const unsigned equal = equal_corners(a, b);
    if (equal == 0) return triangles_meet(a, b);
    const unsigned first = unsigned(std::countr_zero(equal)), i = first / 3, j = first % 3;
    const unsigned second = equal & (equal - 1);
    if (second == 0) {
        return fan_meets_beyond({a[i], {&a[(i + 1) % 3], &a[(i + 2) % 3]}, {&b[(j + 1) % 3], &b[(j + 2) % 3]}});
    }
    if ((second & (second - 1)) != 0) return any_meet_beyond_shared(a, b);
    const unsigned last = unsigned(std::countr_zero(second)), k = last / 3, l = last % 3;
    if (i == k || j == l) return any_meet_beyond_shared(a, b);
    return hinge_meets_beyond({a[i], a[k], a[3 - i - k], b[3 - j - l]});
}

bool is_degenerate(const Triangle3d& triangle) { return facing(triangle).axis == 3; }

}  // namespace octopair
