// convex_contact(): penetration depth of two convex objects.
//
// Depth     The overlap along any direction, computed from two supports, is a depth that separates the objects. The depth is
//           the least overlap.
// Apart     If the cores do not meet, its direction is the one that proves their distance.
// Meeting   If they meet, an expanding polytope finds it (difference_hull.hpp).
// Near      A small depth may be the error of its direction, which matters at the far points of a large object. Then the exact directions of
//           faces and edges are tried, too (face_directions.hpp).
// Safety    If rounding misleads the search, the depth is larger than necessary, but the contact separates the objects.
#include <algorithm>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/difference_hull.hpp"
#include "narrow_phase/convex/face_directions.hpp"
#include "narrow_phase/convex/least_overlap.hpp"
#include "narrow_phase/convex/local_convex.hpp"
#include "narrow_phase/convex/scaled_pair.hpp"

namespace octopair {
namespace {

/// Proposes the axes of the pose of a box or a curved core. They are the exact normals of its plane faces.
void propose_axes(const LocalConvex& convex, LeastOverlap& least) {
    if (!convex.points().empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) least.propose(vector::column(convex.pose(), axis));
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

/// Tries further directions if the depth is so small that it may be the error of the best direction.
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
