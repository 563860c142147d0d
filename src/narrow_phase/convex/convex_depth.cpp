// convex_contact(): penetration depth of two convex objects.
//
// Depth     The overlap along any direction, computed from two supports, is a depth that separates the objects. The depth is
//           the least overlap.
// Apart     If the cores do not meet, its direction is the one that proves their distance.
// Meeting   If they meet, an expanding polytope finds it (find_least_overlap()).
// Near      A small depth may be the error of its direction, which matters at the far points of a large object. Then the exact
//           directions of faces and edges are tried, too (propose_face_directions()).
// Safety    If rounding misleads the search, the depth is larger than necessary, but the contact separates the objects.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/least_overlap.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

/// Proposes the axes of the pose of a box or a curved core, because they are the exact normals of its plane faces.
void propose_axes(const LocalConvex& convex, LeastOverlap& least) {
    if (!convex.points().empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) least.propose(vector::column(convex.pose(), axis));
}

/// Returns a point in both objects. If the cores meet, it is a point in both cores. Otherwise it is on the segment between the cores: the
/// middle of the part that lies within both radii.
Point3d point_in_both(const LocalConvexPair& pair, const CoreGap& core) {
    const Point3d way = vector::minus(core.on_b, core.on_a);
    const double length = vector::length(way);
    if (!(length > 0)) return core.on_a;
    const double begin = std::max(0.0, length - pair.b().radius()), end = std::min(length, pair.a().radius());
    return vector::plus(core.on_a, vector::times(way, (begin + end) / 2 / length));
}

using vector::cross;
using vector::dot;
using vector::minus;
using vector::plus;
using vector::times;

/// Up to six points of a core. Each is farthest along a direction near a given direction. Equal points are stored once.
class NearPoints {
public:
    /// `direction` has length 1.
    NearPoints(const LocalConvex& convex, const Point3d& direction) {
        if (!convex.points().empty()) {
            for (const Point3d& point : convex.points()) add(point);
            return;
        }
        constexpr double aside = 1e-5;
        const auto add_toward = [&](const Point3d& way) {
            const double length = vector::length(way);
            if (length > 0) add(convex.support(plus(direction, times(way, aside / length))));
        };
        const Point3d first = vector::some_normal(direction), second = cross(direction, first);
        for (const Point3d& way : {first, second}) add_toward(way), add_toward(times(way, -1));
        // The third corner of a thin triangle may be farthest only along directions perpendicular to the longest edge, so try these too.
        const Point3d edge = longest_edge(), across = cross(direction, edge);
        add_toward(across), add_toward(times(across, -1));
    }

    std::span<const Point3d> points() const { return {points_.data(), count_}; }

private:
    void add(const Point3d& point) {
        const auto end = points_.begin() + std::ptrdiff_t(count_);
        if (std::find(points_.begin(), end, point) == end) points_[count_++] = point;
    }
    Point3d longest_edge() const {
        Point3d longest = {};
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                const Point3d edge = minus(points_[i], points_[k]);
                if (dot(edge, edge) > dot(longest, longest)) longest = edge;
            }
        }
        return longest;
    }

    std::array<Point3d, 6> points_ = {};
    std::size_t count_ = 0;
};

/// Normals of those faces, and directions of those edges, that a core has near a direction. The vectors have any length.
struct NearFeatures {
    std::array<Point3d, 20> normals = {};
    std::array<Point3d, 15> edges = {};
    std::size_t normal_count = 0, edge_count = 0;

    NearFeatures(const LocalConvex& convex, const Point3d& direction) {
        if (!convex.is_points()) {
            for (std::size_t axis = 0; axis < 3; ++axis) add_axis(vector::column(convex.pose(), axis));
            return;
        }
        const NearPoints near(convex, direction);
        const auto points = near.points();
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const Point3d edge = minus(points[j], points[i]);
                edges[edge_count++] = edge;
                for (std::size_t k = 0; k < j; ++k) normals[normal_count++] = cross(edge, minus(points[k], points[i]));
            }
        }
    }

private:
    void add_axis(const Point3d& axis) { normals[normal_count++] = axis, edges[edge_count++] = axis; }
};

/// Returns the part of `direction` that is perpendicular to `edge`. The second step removes the rounding of the first one.
Point3d turned_across(const Point3d& edge, Point3d direction) {
    for (int step = 0; step < 2; ++step) {
        direction = minus(direction, times(edge, dot(direction, edge) / dot(edge, edge)));
    }
    return direction;
}

/// Proposes directions near least.normal() until the overlap of the cores is at most `enough`. The directions are exact where plane faces
/// and straight edges touch.
/// Requires: a direction has been tried, and the sizes of the pair need no scaling (ScaledPair).
///
/// Use       A search ends when the bounds of the distance agree to the rounding of the pair's size. A direction is then accurate to about
///           this rounding, divided by the size. At the far points of a large face this still is much for a small object on it. The normal
///           of the face itself has no such error.
/// Proposed  The normals of near faces of either core, the cross products of near edges of both, and the best direction made perpendicular
///           to each near edge. Of a core that is no set of points, the axes of its pose stand for normals and edges.
/// Safety    Any direction is an upper bound of the least overlap. So a useless proposal only costs time.
void propose_face_directions(const LocalConvexPair& pair, double enough, LeastOverlap& least) {
    const Point3d direction = least.normal();
    const NearFeatures a(pair.a(), direction), b(pair.b(), times(direction, -1));
    const auto is_enough = [&](const Point3d& proposal) {
        least.propose(proposal);
        return least.overlap() <= enough;
    };
    for (const NearFeatures* one : {&a, &b}) {
        for (std::size_t i = 0; i < one->normal_count; ++i) {
            if (is_enough(one->normals[i])) return;
        }
        for (std::size_t i = 0; i < one->edge_count; ++i) {
            if (is_enough(turned_across(one->edges[i], direction))) return;
        }
    }
    for (std::size_t i = 0; i < a.edge_count; ++i) {
        for (std::size_t k = 0; k < b.edge_count; ++k) {
            if (is_enough(cross(a.edges[i], b.edges[k]))) return;
        }
    }
}

/// Tries further directions if the depth is so small that an error of the best direction may explain the whole depth.
void improve_small_depth(const LocalConvexPair& pair, LeastOverlap& least) {
    constexpr double close = 1e-8, rounding_steps = 64;
    const auto may_be_error = [&](double error) {
        const double depth = least.overlap() + pair.radii();
        return depth > 0 && depth <= error;
    };
    if (may_be_error(close * pair.size())) propose_face_directions(pair, -pair.radii(), least);
    const bool is_curved = pair.a().is_curved() || pair.b().is_curved();
    if (is_curved && may_be_error(rounding_steps * pair.slack())) least.descend();
}

}  // namespace

ConvexContact convex_contact(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair pair(a, b);
    if (ScaledPair::is_needed(pair)) {
        const ScaledPair scaled(a, b, pair);
        const ConvexContact contact = convex_contact(scaled.a(), scaled.b());
        return {scaled.from_units(contact.point), contact.normal, scaled.from_units(contact.depth)};
    }
    const CoreGap core = gjk_distance(pair);
    LeastOverlap least(pair);
    // A gap close to the rounding error has no reliable direction.
    if (core.at_least > 0 && core.at_most > 1e4 * pair.slack()) {
        least.propose(core.direction);
    } else {
        propose_axes(pair.a(), least);
        propose_axes(pair.b(), least);
        (void)find_least_overlap(least, pair.slack());
    }
    improve_small_depth(pair, least);
    const Point3d& normal = least.normal();
    ConvexContact contact;
    contact.depth = std::max(0.0, least.overlap() + pair.radii());
    contact.point = vector::plus(point_in_both(pair, core), pair.origin());
    contact.normal = pair.swapped() ? vector::times(normal, -1) : normal;
    return contact;
}

double convex_depth_at_least(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair pair(a, b);
    if (ScaledPair::is_needed(pair)) {
        const ScaledPair scaled(a, b, pair);
        return scaled.from_units(convex_depth_at_least(scaled.a(), scaled.b()));
    }
    LeastOverlap least(pair);
    propose_axes(pair.a(), least);
    propose_axes(pair.b(), least);
    return std::max(0.0, find_least_overlap(least, pair.slack()) + pair.radii());
}

}  // namespace octopair
