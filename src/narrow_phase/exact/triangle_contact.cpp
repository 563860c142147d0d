#include "narrow_phase/exact/triangle_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/exact/centered_triangles.hpp"
#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/plane_crossing.hpp"
#include "narrow_phase/exact/ray_parity.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {
namespace {

using vector::cross;
using vector::dot;
using vector::minus;
using vector::times;

Point3d between(const Point3d& from, const Point3d& to, double part) {
    return {std::lerp(from[0], to[0], part), std::lerp(from[1], to[1], part), std::lerp(from[2], to[2], part)};
}

/// A triangle that crosses the plane of another one.
struct CrossingTriangle {
    const Triangle3d& triangle;
    const CornerSides& sides;
    const PlaneCrossing::CornerOrder& corners;
    const Triangle3d& other;

    /// Returns the point where edge 0i crosses the plane.
    Point3d on_edge(unsigned i) const {
        const Point3d &from = triangle[corners[0]], &to = triangle[corners[i]];
        if (sides[corners[0]] == 0) return from;
        if (sides[corners[i]] == 0) return to;
        return between(from, to, part_to_plane(other, from, to));
    }
};

bool on_both_sides(const CornerSides& sides) {
    return std::min({sides[0], sides[1], sides[2]}) < 0 && std::max({sides[0], sides[1], sides[2]}) > 0;
}

/// Returns the contact of triangles in different planes. Each crosses the planes' common line in a segment; the contact runs
/// from the later begin to the earlier end of the two segments.
TriangleContact crossing_contact(const std::array<Triangle3d, 2>& triangles, const std::array<CornerSides, 2>& sides) {
    TriangleContact contact;
    const auto& [a, b] = triangles;
    const PlaneCrossing line(a, sides[0], b, sides[1]);
    const int begins = line.order(1, 1), ends = line.order(2, 2);
    if (begins > 0 || ends < 0) return contact;
    const bool a_is_point = sides[0][line.first()[0]] == 0, b_is_point = sides[1][line.second()[0]] == 0;
    const CrossingTriangle of_a{a, sides[0], line.first(), b}, of_b{b, sides[1], line.second(), a};
    contact.points[0] = line.order(1, 2) >= 0 ? of_a.on_edge(1) : of_b.on_edge(2);
    contact.points[1] = line.order(2, 1) <= 0 ? of_a.on_edge(2) : of_b.on_edge(1);
    contact.count = begins == 0 || ends == 0 || a_is_point || b_is_point ? 1 : 2;
    const bool pass = begins < 0 && ends > 0 && on_both_sides(sides[0]) && on_both_sides(sides[1]);
    contact.meeting = pass ? TriangleMeeting::crossing : TriangleMeeting::touching;
    return contact;
}

/// Corners and edges of a triangle. For a degenerate triangle: the ends and the edge of its segment, or its only point.
class Outline {
public:
    explicit Outline(const Triangle3d& triangle) : projection_(projection_of(triangle)), corners_(triangle) {
        if (projection_.axis < 3) return;
        const auto [low, high] = hull_of_degenerate(triangle);
        corners_ = {low, high, high};
        count_ = low == high ? 1 : 2;
    }

    const Projection& projection() const { return projection_; }
    std::size_t corners() const { return count_; }
    const Point3d& corner(std::size_t i) const { return corners_[i]; }
    std::size_t edges() const { return count_ == 3 ? 3 : count_ - 1; }
    Segment3d edge(std::size_t i) const { return {corners_[i], corners_[(i + 1) % count_]}; }

private:
    Projection projection_;
    std::size_t count_ = 3;
    Triangle3d corners_;
};

/// Contact of triangles that are coplanar or degenerate. Their intersection is a convex set. Its corners are corners of the
/// triangles, crossings of two edges, and crossings of a segment with a triangle.
class FlatContact {
public:
    FlatContact(const Triangle3d& a, const Triangle3d& b) : a_(a), b_(b) {
        for (std::size_t i = 0; i < a_.corners(); ++i) try_corner(a_.corner(i), b);
        for (std::size_t i = 0; i < b_.corners(); ++i) try_corner(b_.corner(i), a);
        for (std::size_t i = 0; i < a_.edges(); ++i) {
            for (std::size_t j = 0; j < b_.edges(); ++j) try_edges(i, j);
        }
        if (a_.edges() == 1 && b_.edges() == 3) try_segment(a_, b);
        if (b_.edges() == 1 && a_.edges() == 3) try_segment(b_, a);
    }

    TriangleContact contact() && {
        if (contact_.count > 2) put_in_order();
        contact_.meeting = contact_.count > 2   ? TriangleMeeting::overlapping
                           : contact_.count > 0 ? TriangleMeeting::touching
                                                : TriangleMeeting::none;
        return contact_;
    }

private:
    void add(const Point3d& place) {
        if (contact_.count < contact_.points.size()) contact_.points[contact_.count++] = place;
    }

    void try_corner(const Point3d& corner, const Triangle3d& other) {
        const auto end = contact_.points.begin() + contact_.count;
        if (std::find(contact_.points.begin(), end, corner) == end && point_on_triangle(corner, other)) add(corner);
    }

    /// Adds the crossing of two edges if it is in the interior of both.
    void try_edges(std::size_t i, std::size_t j) {
        const Segment3d s = a_.edge(i), t = b_.edge(j);
        if (plane_side(s[0], s[1], t[0], t[1]) != 0) return;
        const unsigned axis = projection_axis(s, t);
        if (axis == 3 || line_side(t[0], t[1], s[0], axis) * line_side(t[0], t[1], s[1], axis) >= 0 ||
            line_side(s[0], s[1], t[0], axis) * line_side(s[0], s[1], t[1], axis) >= 0) {
            return;
        }
        add(between(s[0], s[1], part_to_line({t[0], t[1], axis}, s[0], s[1])));
    }

    /// Adds the crossing of a segment and a triangle if it is in the interior of both.
    void try_segment(const Outline& segment, const Triangle3d& triangle) {
        const auto [begin, end] = segment.edge(0);
        const PlaneSides plane(triangle);
        if (plane(begin) * plane(end) >= 0) return;
        const int first = plane_side(begin, end, triangle[0], triangle[1]);
        if (first == 0 || plane_side(begin, end, triangle[1], triangle[2]) != first ||
            plane_side(begin, end, triangle[2], triangle[0]) != first) {
            return;
        }
        add(between(begin, end, part_to_plane(triangle, begin, end)));
    }

    /// Sorts the points by angle around their mean, in the projection along the axis.
    void put_in_order() {
        const unsigned axis = a_.projection().axis;
        const unsigned u = axis == 2 ? 0 : axis + 1, v = axis == 0 ? 2 : axis - 1;
        const auto begin = contact_.points.begin(), end = begin + contact_.count;
        double middle_u = 0, middle_v = 0;
        for (auto point = begin; point != end; ++point) {
            middle_u += (*point)[u] / contact_.count;
            middle_v += (*point)[v] / contact_.count;
        }
        const auto before = [&](const Point3d& first, const Point3d& second) {
            return std::atan2(first[v] - middle_v, first[u] - middle_u) <
                   std::atan2(second[v] - middle_v, second[u] - middle_u);
        };
        for (auto next = begin; next != end; ++next) {
            std::rotate(std::upper_bound(begin, next, *next, before), next, next + 1);
        }
    }

    Outline a_, b_;
    TriangleContact contact_;
};

struct TriangleExtent {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    TriangleExtent(const Triangle3d& triangle, const Point3d& direction) {
        for (const Point3d& corner : triangle) {
            const double at = dot(direction, corner);
            low = std::min(low, at), high = std::max(high, at);
        }
    }
};

/// The shortest translation that separates two triangles, among translations along the directions that were tried.
class MinimumTranslation {
public:
    explicit MinimumTranslation(const CenteredTriangles& near) : near_(near) {}

    void offer(const Point3d& direction) {
        const double length = vector::length(direction);
        if (!(length > 1e-300)) return;
        const Point3d normal = times(direction, 1 / length);
        const TriangleExtent a(near_.a, normal), b(near_.b, normal);
        const double forward = a.high - b.low, backward = b.high - a.low;
        const double depth = std::max(0.0, std::min(forward, backward));
        if (found_ && !(depth < out_.depth)) return;
        found_ = true;
        out_ = {forward <= backward ? normal : times(normal, -1), depth};
    }

    bool found() const { return found_; }
    TriangleDepth out() const { return {out_.normal, near_.back(out_.depth)}; }

private:
    const CenteredTriangles& near_;
    bool found_ = false;
    TriangleDepth out_;
};

/// Returns the cross product, made perpendicular to the longer vector. Rounding decides the direction of the cross product of
/// almost parallel vectors, which is then perpendicular to neither.
Point3d across(const Point3d& a, const Point3d& b) {
    const Point3d product = cross(a, b);
    const Point3d& longer = dot(a, a) < dot(b, b) ? b : a;
    const double square = dot(longer, longer);
    return square > 0 ? minus(product, times(longer, dot(product, longer) / square)) : product;
}

}  // namespace

TriangleContact triangle_contact(const Triangle3d& a, const Triangle3d& b) {
    const auto a_sides = corner_sides(PlaneSides(b), a);
    if (on_one_side(a_sides)) return {};
    const auto b_sides = corner_sides(PlaneSides(a), b);
    if (on_one_side(b_sides)) return {};
    if (in_plane(a_sides) || in_plane(b_sides)) return FlatContact(a, b).contact();
    return crossing_contact({a, b}, {a_sides, b_sides});
}

TriangleDepth triangle_depth(const Triangle3d& a, const Triangle3d& b) {
    const CenteredTriangles near(a, b);
    std::array<Point3d, 3> a_edges, b_edges;
    for (std::size_t i = 0; i < 3; ++i) {
        a_edges[i] = minus(near.a[(i + 1) % 3], near.a[i]);
        b_edges[i] = minus(near.b[(i + 1) % 3], near.b[i]);
    }
    MinimumTranslation least(near);
    least.offer(across(a_edges[0], a_edges[1]));
    least.offer(across(b_edges[0], b_edges[1]));
    for (const Point3d& a_edge : a_edges) {
        for (const Point3d& b_edge : b_edges) least.offer(across(a_edge, b_edge));
    }
    for (const auto* edges : {&a_edges, &b_edges}) {
        // No direction was tried, because all edges are parallel to one line. Any translation across this line separates the triangles.
        for (const Point3d& edge : *edges) {
            if (!least.found()) least.offer(vector::some_normal(edge));
        }
    }
    return least.out();
}

Contact contact_of(const Triangle3d& a, const Triangle3d& b, const TriangleContact& common) {
    Contact contact = {};
    for (unsigned i = 0; i < common.count; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) contact.point[axis] += common.points[i][axis] / common.count;
    }
    const TriangleDepth way_out = triangle_depth(a, b);
    contact.normal = way_out.normal;
    contact.depth = way_out.depth;
    return contact;
}

}  // namespace octopair
