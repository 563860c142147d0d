#include "narrow_phase/plane_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
PlaneSpan span_across(const PosedPlane& plane, const PosedConvex& convex) {
    const LocalConvex local(convex, plane.point);
    const Point3d down = vector::times(plane.normal, -1);
    const Point3d highest = local.support(plane.normal), lowest = local.support(down);
    const double radius = local.radius();
    // Upper bound on the numbers that a height is computed from. So the error covers the rounding of supports, of the plane's point and
    // of its normal.
    double largest = 3 * local.magnitude() + radius;
    for (const double at : plane.point) largest = std::max(largest, std::fabs(at));
    const double slack = 16 * std::numeric_limits<double>::epsilon() * largest;
    PlaneSpan span;
    span.high = vector::dot(highest, plane.normal) + radius + slack;
    span.low = vector::dot(lowest, plane.normal) - radius - slack;
    span.highest = vector::plus(vector::plus(highest, vector::times(plane.normal, radius)), plane.point);
    span.lowest = vector::plus(vector::plus(lowest, vector::times(down, radius)), plane.point);
    return span;
}

ConvexGap plane_gap(const PosedPlane& plane, const PlaneSpan& span) {
    ConvexGap gap;
    gap.at_least = std::max({0.0, span.low, -span.high});
    const bool above = span.low > -span.high;
    gap.on_b = above ? span.lowest : span.highest;
    const double height = height_above(plane, gap.on_b);
    gap.on_a = vector::minus(gap.on_b, vector::times(plane.normal, height));
    if (gap.at_least > 0) gap.distance = std::max(gap.at_least, std::fabs(height));
    return gap;
}

ConvexContact plane_contact(const PosedPlane& plane, const PlaneSpan& span) {
    // The shorter of two translations: up until the lowest point is on the plane, or down until the highest point is on the plane.
    const bool up = -span.low <= span.high;
    ConvexContact contact;
    contact.normal = up ? plane.normal : vector::times(plane.normal, -1);
    const Point3d& deepest = up ? span.lowest : span.highest;
    const double height = height_above(plane, deepest);
    contact.depth = std::max(0.0, up ? -height : height);
    contact.point = vector::plus(deepest, vector::times(contact.normal, contact.depth / 2));
    return contact;
}

namespace {

/// Calls visit(span) for each triangle of the mesh, until `visit` returns false.
template <typename Visit>
void visit_spans(const PosedPlane& plane, const PosedMesh& mesh, const Visit& visit) {
    for (std::uint32_t i = 0; i < mesh.tree.triangles.size(); ++i) {
        const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, i);
        if (!visit(span_across(plane, PosedConvex(triangle)))) return;
    }
}

}  // namespace

bool surface_meets(const PosedMesh& mesh, const PosedPlane& plane) {
    bool found = false;
    visit_spans(plane, mesh, [&](const PlaneSpan& span) {
        found = meets(span);
        return !found;
    });
    return found;
}

std::optional<PlaneSpan> span_across(const PosedPlane& plane, const PosedMesh& mesh) {
    std::optional<PlaneSpan> all;
    visit_spans(plane, mesh, [&](const PlaneSpan& span) {
        if (!all) all = span;
        if (span.low < all->low) {
            all->low = span.low;
            all->lowest = span.lowest;
        }
        if (span.high > all->high) {
            all->high = span.high;
            all->highest = span.highest;
        }
        return true;
    });
    return all;
}

std::optional<ConvexGap> plane_gap(const PosedPlane& plane, const PosedMesh& mesh) {
    std::optional<ConvexGap> least;
    visit_spans(plane, mesh, [&](const PlaneSpan& span) {
        const ConvexGap gap = plane_gap(plane, span);
        if (!least || gap.distance < least->distance) least = gap;
        return true;
    });
    return least;
}

}  // namespace octopair
