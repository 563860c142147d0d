// convex_contact(): penetration depth of two convex objects.
//
// Depth     The overlap along any direction, computed from two supports, is a depth that separates the objects. The search
//           looks for the direction with the smallest overlap.
// Apart     If the cores do not meet, that is the direction between their nearest points.
// Meeting   If they meet, libccd's expanding polytope algorithm proposes a direction. It fails on flat objects, so axes, edges
//           and faces of both objects are proposed as well. Gradient descent then improves the best proposal.
// Safety    An error of libccd can make the depth larger than necessary, but the contact always separates the objects.
#include <ccd/ccd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

/// A convex object scaled for libccd, whose tolerances are absolute. The polytope of a touching pair may grow without end, so
/// after 256 supports every support is the origin, and the polytope cannot grow further.
struct Scaled {
    const LocalConvex* convex;
    double scale;
    mutable int supports_left = 256;
};

void support_scaled(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* farthest) {
    const auto& scaled = *static_cast<const Scaled*>(object);
    if (scaled.supports_left-- <= 0) return ccdVec3Set(farthest, 0, 0, 0);
    const Point3d point = scaled.convex->support({direction->v[0], direction->v[1], direction->v[2]});
    ccdVec3Set(farthest, point[0] * scaled.scale, point[1] * scaled.scale, point[2] * scaled.scale);
}

/// The direction of smallest overlap among those proposed.
class LeastOverlap {
public:
    explicit LeastOverlap(const LocalConvexPair& pair) : pair_(pair) {}

    void propose(const Point3d& direction) {
        const double length = vector::length(direction);
        if (!(length > 0) || !std::isfinite(length)) return;
        const Point3d normal = {direction[0] / length, direction[1] / length, direction[2] / length};
        consider(normal);
        consider(vector::times(normal, -1));
    }

    /// Gradient descent: turns the direction against the part of the support vertex that is perpendicular to it, while that
    /// reduces the overlap.
    void descend() {
        double step = 1;
        for (int i = 0; i < 64 && step > 1e-9; ++i) {
            const Point3d aside = vector::minus(vertex_, vector::times(normal_, vector::dot(vertex_, normal_)));
            const double length = vector::length(vertex_), before = overlap_;
            if (!(length > 0)) return;
            const Point3d turned = vector::minus(normal_, vector::times(aside, step / length));
            const double size = vector::length(turned);
            if (size > 0) consider(vector::times(turned, 1 / size));
            step = overlap_ < before ? std::min(1.0, step * 1.5) : step / 4;
        }
    }

    const Point3d& normal() const { return normal_; }
    /// Overlap along normal(), including the radii; below 0 if the objects are apart along the normal.
    double overlap() const { return overlap_ + pair_.radii(); }
    const Point3d& on_a() const { return on_a_; }
    const Point3d& on_b() const { return on_b_; }

private:
    void consider(const Point3d& normal) {
        const Point3d on_a = pair_.a().support(normal), on_b = pair_.b().support(vector::times(normal, -1));
        const Point3d vertex = vector::minus(on_a, on_b);
        const double overlap = vector::dot(vertex, normal);
        if (!(overlap < overlap_)) return;
        overlap_ = overlap, normal_ = normal, vertex_ = vertex, on_a_ = on_a, on_b_ = on_b;
    }

    const LocalConvexPair& pair_;
    double overlap_ = std::numeric_limits<double>::infinity();
    Point3d normal_ = {1, 0, 0}, vertex_ = {}, on_a_ = {}, on_b_ = {};
};

void propose_by_polytope(const LocalConvexPair& pair, LeastOverlap& least) {
    const double size = pair.a().magnitude() + pair.b().magnitude();
    if (!std::isfinite(1 / size)) return;  // so small that float64 has no digits for a polytope
    const Scaled a = {&pair.a(), 1 / size}, b = {&pair.b(), 1 / size};
    ccd_t settings;
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support_scaled;
    settings.max_iterations = 200;
    // The tolerance applies to a difference of squares: 1e-8 makes a small depth wrong by a tenth.
    settings.epa_tolerance = 1e-11;
    ccd_real_t depth = 0;
    ccd_vec3_t way, place;
    if (ccdGJKPenetration(&a, &b, &settings, &depth, &way, &place) == 0) least.propose({way.v[0], way.v[1], way.v[2]});
}

/// Returns the edges between the points of a core of at most 4 points; for other cores, the axes of their pose.
std::vector<Point3d> edges_of(const LocalConvex& convex) {
    std::vector<Point3d> edges;
    const auto points = convex.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) edges.push_back(vector::minus(points[i], points[j]));
    }
    if (!points.empty()) return edges;
    for (std::size_t axis = 0; axis < 3; ++axis) edges.push_back(vector::column(convex.pose(), axis));
    return edges;
}

/// Returns a direction across the two longest extents of the core: the normal of a flat object.
Point3d thinnest_direction(const LocalConvex& convex) {
    const Point3d from = convex.middle();
    Point3d along = {}, across = {};
    double longest = 0, widest = 0;
    for (const bool second : {false, true}) {
        for (const Point3d& probe : {Point3d{1, 0, 0}, Point3d{0, 1, 0}, Point3d{0, 0, 1}, Point3d{1, 1, 1}}) {
            for (const double sign : {1.0, -1.0}) {
                const Point3d way = vector::minus(convex.support(vector::times(probe, sign)), from);
                const Point3d area = vector::cross(along, way);
                if (!second && vector::length(way) > longest) longest = vector::length(way), along = way;
                if (second && vector::length(area) > widest) widest = vector::length(area), across = area;
            }
        }
    }
    return across;
}

void propose_by_features(const LocalConvexPair& pair, LeastOverlap& least) {
    const Point3d between = vector::minus(pair.b().middle(), pair.a().middle());
    least.propose({1, 0, 0});
    least.propose(between);
    const std::vector<Point3d> edges_a = edges_of(pair.a()), edges_b = edges_of(pair.b());
    for (const auto* edges : {&edges_a, &edges_b}) {
        for (const Point3d& edge : *edges) {
            least.propose(edge);
            least.propose(vector::cross(edge, vector::cross(between, edge)));
        }
        for (std::size_t i = 0; i < edges->size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) least.propose(vector::cross((*edges)[i], (*edges)[j]));
        }
    }
    for (const Point3d& a : edges_a) {
        for (const Point3d& b : edges_b) least.propose(vector::cross(a, b));
    }
    least.propose(thinnest_direction(pair.a()));
    least.propose(thinnest_direction(pair.b()));
}

/// Returns the middle of the part of the segment between the cores that lies within both radii; if the cores meet, a point in
/// both.
Point3d point_in_both(const LocalConvexPair& pair, const CoreGap& core) {
    const Point3d way = vector::minus(core.on_b, core.on_a);
    const double length = vector::length(way);
    if (!(length > 0)) return core.on_a;
    const double begin = std::max(0.0, length - pair.b().radius()), end = std::min(length, pair.a().radius());
    return vector::plus(core.on_a, vector::times(way, (begin + end) / 2 / length));
}

}  // namespace

ConvexContact convex_contact(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair pair(a, b);
    const CoreGap core = gjk_distance(pair);
    LeastOverlap least(pair);
    const Point3d way = vector::minus(core.on_b, core.on_a);
    // A gap close to the rounding error has no reliable direction.
    if (core.at_least > 0 && core.at_most > 1e4 * pair.slack()) {
        least.propose(way);
    } else {
        propose_by_polytope(pair, least);
        propose_by_features(pair, least);
        least.descend();
    }
    const Point3d& normal = least.normal();
    ConvexContact contact;
    contact.depth = std::max(0.0, least.overlap());
    contact.point = vector::plus(point_in_both(pair, core), pair.origin());
    contact.normal = pair.swapped() ? vector::times(normal, -1) : normal;
    return contact;
}

}  // namespace octopair
