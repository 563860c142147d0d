// triangle_gap(): nearest points of two triangles.
//
// Cases     Two edges, a corner and an edge, or a corner and the interior of the other triangle. All cases are tried.
// Safety    Each candidate is a point of its triangle, whatever the rounding of its parameters. So no distance is too small.
// Accuracy  If one candidate is imprecise (almost parallel edges, slivers), another candidate is as near.
#include "narrow_phase/exact/triangle_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/exact/centered_triangles.hpp"
#include "narrow_phase/exact/triangle_contact.hpp"

namespace octopair {
namespace {

using vector::cross;
using vector::dot;
using vector::minus;
using vector::plus;
using vector::times;

/// The nearest pair of points among the candidates that were tried.
struct Nearest {
    Point3d on_a = {}, on_b = {};
    double square = std::numeric_limits<double>::infinity();

    void offer(const Point3d& a, const Point3d& b) {
        const Point3d way = minus(b, a);
        const double offered = dot(way, way);
        if (!(offered < square)) return;
        on_a = a, on_b = b, square = offered;
    }
};

/// Returns the point nearest to `place` on the segment from the origin to `way`, as a fraction of the segment, 0 to 1.
double part_nearest(const Point3d& way, const Point3d& place) {
    const double square = dot(way, way);
    return square > 0 ? std::clamp(dot(way, place) / square, 0.0, 1.0) : 0.0;
}

struct GapEdge {
    const Point3d& begin;
    Point3d way;
    GapEdge(const Point3d& from, const Point3d& to) : begin(from), way(minus(to, from)) {}
    Point3d at(double part) const { return plus(begin, times(way, part)); }
    Point3d nearest(const Point3d& place) const { return at(part_nearest(way, minus(place, begin))); }
};

/// Tries the nearest points of the two edges' lines as a candidate, if both points lie strictly between the ends of their edges.
void try_edges(const GapEdge& a, const GapEdge& b, Nearest& nearest) {
    const Point3d between = minus(a.begin, b.begin);
    const double aa = dot(a.way, a.way), ab = dot(a.way, b.way), bb = dot(b.way, b.way);
    const double a_between = dot(a.way, between), b_between = dot(b.way, between);
    const double determinant = aa * bb - ab * ab;
    const double a_part = (ab * b_between - bb * a_between) / determinant;
    const double b_part = (aa * b_between - ab * a_between) / determinant;
    const auto is_inside = [](double part) { return part > 0 && part < 1; };
    if (is_inside(a_part) && is_inside(b_part)) nearest.offer(a.at(a_part), b.at(b_part));
}

/// A triangle with the vectors that are needed to project a point onto its plane.
struct Face {
    const Point3d& corner;
    GapEdge first, second;
    Point3d normal;
    double square;

    explicit Face(const Triangle3d& triangle)
        : corner(triangle[0]),
          first(triangle[0], triangle[1]),
          second(triangle[0], triangle[2]),
          normal(cross(first.way, second.way)),
          square(dot(normal, normal)) {}

    /// Returns true if the projection of `place` is in the interior of the triangle; then sets `nearest` to it.
    bool nearest_inside(const Point3d& place, Point3d& nearest) const {
        const Point3d way = minus(place, corner);
        const double first_part = dot(cross(way, second.way), normal) / square;
        const double second_part = dot(cross(first.way, way), normal) / square;
        if (!(first_part > 0 && second_part > 0 && first_part + second_part < 1)) return false;
        nearest = plus(first.at(first_part), times(second.way, second_part));
        return true;
    }
};

Nearest nearest_of(const Triangle3d& a, const Triangle3d& b) {
    Nearest nearest;
    const std::array<GapEdge, 3> a_edges = {GapEdge{a[0], a[1]}, {a[1], a[2]}, {a[2], a[0]}};
    const std::array<GapEdge, 3> b_edges = {GapEdge{b[0], b[1]}, {b[1], b[2]}, {b[2], b[0]}};
    const Face a_face(a), b_face(b);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            nearest.offer(a[i], b_edges[j].nearest(a[i]));
            nearest.offer(a_edges[j].nearest(b[i]), b[i]);
            try_edges(a_edges[i], b_edges[j], nearest);
        }
        Point3d inside;
        if (b_face.nearest_inside(a[i], inside)) nearest.offer(a[i], inside);
        if (a_face.nearest_inside(b[i], inside)) nearest.offer(inside, b[i]);
    }
    return nearest;
}

}  // namespace

TriangleGap triangle_gap(const Triangle3d& a, const Triangle3d& b) {
    if (triangles_meet(a, b)) {
        const Point3d place = triangle_contact(a, b).points[0];
        return {0, {place, place}};
    }
    const CenteredTriangles near(a, b);
    const Nearest nearest = nearest_of(near.a, near.b);
    return {near.back(vector::length(minus(nearest.on_b, nearest.on_a))),
            {near.back(nearest.on_a), near.back(nearest.on_b)}};
}

double triangle_gap(const Point3d& point, const Triangle3d& triangle) {
    const Triangle3d place = {point, point, point};
    const CenteredTriangles near(place, triangle);
    const Triangle3d& corners = near.b;  // coordinates relative to `point`
    Nearest nearest;
    for (const GapEdge& edge :
         {GapEdge{corners[0], corners[1]}, GapEdge{corners[1], corners[2]}, GapEdge{corners[2], corners[0]}}) {
        nearest.offer({}, edge.nearest({}));
    }
    Point3d inside;
    if (Face(corners).nearest_inside({}, inside)) nearest.offer({}, inside);
    const double distance = near.back(vector::length(nearest.on_b));
    double largest = 0;
    for (const Point3d& corner : {point, triangle[0], triangle[1], triangle[2]}) {
        for (const double at : corner) largest = std::max(largest, std::fabs(at));
    }
    return distance <= largest * 1e-12 && triangles_meet(place, triangle) ? 0 : distance;
}

}  // namespace octopair
