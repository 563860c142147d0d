#include "narrow_phase/exact/triangle_pair.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/plane_crossing.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {
namespace {

/// Positions of points along a direction, relative to an origin. Any direction is valid for a separation test, so rounding of
/// the direction does not matter. A position errs by at most four roundings of the sum of its terms' absolute values.
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

    /// Returns true if `difference`, of two positions, exceeds its rounding error. Returns false if a position was not finite.
    bool clear(double difference) const { return difference > 0x1p-49 * sizes_ + filter::underflow; }

private:
    const Point3d& origin_;
    Point3d direction_;
    double sizes_ = 0;
};

/// Returns true if float64 finds a separating plane perpendicular to the line between the triangles' centroids. Saves exact
/// arithmetic for neighbours in a flat part of a mesh.
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

/// Returns the side of the plane for each corner of the triangle; 0 for corners whose side float64 cannot decide.
CornerSides rounded_sides(const PlaneSides& plane, const Triangle3d& triangle) {
    return {plane.rounded(triangle[0]), plane.rounded(triangle[1]), plane.rounded(triangle[2])};
}
bool are_sure(const CornerSides& sides) { return sides[0] != 0 && sides[1] != 0 && sides[2] != 0; }

/// Returns true if some edge of `a` has all of `b` on its outer side. Requires: the triangles lie in one plane.
bool edge_separates(const Triangle3d& a, const Projection& projection, const Triangle3d& b) {
    for (std::size_t i = 0; i < 3; ++i) {
        const auto outside = [&](const Point3d& corner) {
            return line_side(a[i], a[(i + 1) % 3], corner, projection.axis) * projection.side < 0;
        };
        if (std::all_of(b.begin(), b.end(), outside)) return true;
    }
    return false;
}

/// Returns true if the triangles have a common point. Requires: the triangles lie in one plane, or one of them is degenerate.
bool flat_triangles_meet(const Triangle3d& a, const Triangle3d& b) {
    const Projection a_projection = projection_of(a), b_projection = projection_of(b);
    if (a_projection.axis == 3) return segment_meets_triangle(hull_of_degenerate(a), b);
    if (b_projection.axis == 3) return segment_meets_triangle(hull_of_degenerate(b), a);
    return !edge_separates(a, a_projection, b) && !edge_separates(b, b_projection, a);
}

/// Two triangles with one common corner, given by their other corners.
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

/// Returns two triangles that together cover the triangle of the shared corner and `others`. They are the triangle itself, twice. If it is
/// degenerate, they are the two segments from the shared corner, as triangles.
std::array<Triangle3d, 2> parts_of(const Point3d& shared, const std::array<const Point3d*, 2>& others) {
    const Triangle3d whole = {shared, *others[0], *others[1]};
    if (!is_degenerate(whole)) return {whole, whole};
    return {Triangle3d{shared, *others[0], *others[0]}, Triangle3d{shared, *others[1], *others[1]}};
}

/// Slow version of fan_meets_beyond(), for coplanar and degenerate triangles. The ray from the shared corner through a common
/// point leaves each triangle through the opposite edge; the nearer of the two exits is a common point as well.
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

/// Returns true if the triangles meet beyond their shared corner. Both planes and their common line pass through that corner.
/// A triangle whose other corners are not on one side of the other plane contains a part of the line from the corner on.
/// This part goes to the positive end if the first of these corners is the higher one (directions: plane_crossing.hpp).
/// The triangles meet beyond the corner if both parts go to the same end.
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

/// Two triangles with a common edge.
struct Hinge {
    const Point3d &begin, &end;
    const Point3d &a, &b;  ///< third corner of each triangle; not an end of the edge
};

/// Returns true if, projected along some axis, the third corners are certainly on different sides of the edge.
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

/// Returns true if the triangles meet beyond their common edge: they are coplanar and folded onto each other. If all corners
/// lie on one line, both triangles must extend past the same end of the edge.
bool hinge_meets_beyond(const Hinge& hinge) {
    if (clearly_apart(hinge)) return false;
    const auto& [begin, end, a, b] = hinge;
    if (plane_side(begin, end, a, b) != 0) return false;
    const Projection a_projection = projection_of({begin, end, a}), b_projection = projection_of({begin, end, b});
    if (a_projection.axis < 3 && b_projection.axis < 3)
        return line_side(begin, end, b, a_projection.axis) * a_projection.side > 0;
    if (a_projection.axis < 3 || b_projection.axis < 3) return false;
    const auto& [low, high] = std::minmax(begin, end);
    return (a < low && b < low) || (a > high && b > high);
}

/// Returns a bit mask: bit 3 * i + j is set if corner i of a equals corner j of b.
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

/// The distinct corners of a triangle, those shared with the other triangle first.
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

/// General version of meet_beyond_shared(). Requires: the triangles share a corner. A triangle may have equal corners.
bool any_meet_beyond_shared(const Triangle3d& a, const Triangle3d& b) {
    const DistinctCorners of_a(a, b), of_b(b, a);
    if (of_a.shared == 3) return !is_degenerate(a);
    // A triangle without other corners is equal to the shared feature.
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

bool is_degenerate(const Triangle3d& triangle) { return projection_of(triangle).axis == 3; }

}  // namespace octopair
