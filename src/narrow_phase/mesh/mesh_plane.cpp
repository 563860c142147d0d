#include "narrow_phase/mesh/mesh_plane.hpp"

#include <algorithm>

namespace octopair {

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
