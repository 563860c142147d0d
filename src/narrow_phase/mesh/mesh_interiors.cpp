// Whether the interiors of two meshes that touch have a point in common. Exact.
//
// Touch     Triangles of the meshes meet, but none pass through each other. Then no triangle's interior is cut by an edge of
//           the other mesh, except by edges that lie in its plane. These edges divide the triangle into faces.
// Faces     Each face lies inside the other mesh, outside, or on its surface. If the interiors have points in common, so does
//           a face of a triangle that touches (its sides have, if it lies on the other surface), or a whole part that
//           touches nothing. One point near a corner of each face decides (nearby_point.hpp).
#include "narrow_phase/mesh/mesh_contacts.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "narrow_phase/exact/divided_triangle.hpp"
#include "narrow_phase/exact/nearby_point.hpp"
#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/exact/segment_pair.hpp"

namespace octopair {

namespace {

/// The two meshes of a pair, in one of two roles: faces and parts of `own` are tested against the interior of `other`.
struct View {
    const PosedMesh& own;
    const PosedMesh& other;
    std::uint32_t TouchingTriangles::*own_place;
    std::uint32_t TouchingTriangles::*other_place;
};

/// Tests the face of the own mesh that holds `point`. Returns true if the face lies inside the other mesh. Also returns true if it lies
/// on the other mesh's surface, with the interiors of both meshes on the same side.
bool face_meets(const View& view, NearbyPoint point) {
    std::array<bool, 2> inside;
    for (const std::size_t i : {0U, 1U}) {
        point.sense = i == 0 ? 1 : -1;
        inside[i] = encloses(view.other, point);
    }
    if (inside[0] == inside[1]) return inside[0];
    point.sense = inside[0] ? 1 : -1;
    return encloses(view.own, point);
}

/// Returns true if a face of an own triangle that touches meets the interior of the other mesh.
bool faces_meet(const View& view, std::vector<TouchingTriangles> touching, const std::stop_token& stop) {
    if (!view.other.tree.parts.any_closed) return false;
    std::sort(touching.begin(), touching.end(), [&](const TouchingTriangles& x, const TouchingTriangles& y) {
        return x.*view.own_place < y.*view.own_place;
    });
    for (std::size_t begin = 0, end = 0; begin < touching.size() && !stop.stop_requested(); begin = end) {
        const std::uint32_t place = touching[begin].*view.own_place;
        while (end < touching.size() && touching[end].*view.own_place == place) ++end;
        const Triangle3d triangle = view.own.tree.world_triangle(view.own.pose, place);
        const Projection projection = projection_of(triangle);
        if (projection.axis == 3) continue;  // degenerate: faces of neighbouring triangles reach all its points
        DividedTriangle divided(triangle, projection);
        for (std::size_t i = begin; i < end; ++i) {
            divided.divide(view.other.tree.world_triangle(view.other.pose, touching[i].*view.other_place));
        }
        if (divided.any_face([&](const NearbyPoint& point) { return face_meets(view, point); })) return true;
    }
    return false;
}

/// Returns true if a part of the own mesh that touches nothing lies inside the other mesh.
bool part_is_inside(const View& view, std::span<const TouchingTriangles> touching) {
    const MeshParts& parts = view.own.tree.parts;
    std::vector<bool> touches(parts.corners.size());
    for (const TouchingTriangles& pair : touching) touches[parts.numbers[pair.*view.own_place]] = true;
    for (std::size_t part = 0; part < touches.size(); ++part) {
        if (!touches[part] && encloses(view.other, vector::posed(view.own.pose, parts.corners[part]))) return true;
    }
    return false;
}

/// Returns the side of the plane on which all triangles of a mesh lie, 1 or -1; or 0 if they lie on both sides or in the plane.
int side_of_mesh(const PlaneSides& plane, const PosedMesh& mesh) {
    int all = 0;
    for (const auto& corners : mesh.tree.triangles) {
        for (const std::uint32_t corner : corners) {
            const int side = plane(vector::posed(mesh.pose, mesh.tree.vertices[corner]));
            if (side * all < 0) return 0;
            all += all == 0 ? side : 0;
        }
    }
    return all;
}

/// Returns true if the meshes lie on different sides of the plane of a touching triangle. Tries only a few of these planes.
bool are_separated(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching) {
    constexpr std::size_t tries = 4;
    for (std::size_t i = 0; i < tries && i < touching.size(); ++i) {
        const TouchingTriangles& pair = touching[i * touching.size() / std::min(tries, touching.size())];
        for (const Triangle3d& triangle :
             {a.tree.world_triangle(a.pose, pair.a), b.tree.world_triangle(b.pose, pair.b)}) {
            if (projection_of(triangle).axis == 3) continue;
            const PlaneSides plane(triangle);
            const int side = side_of_mesh(plane, a);
            if (side != 0 && side_of_mesh(plane, b) == -side) return true;
        }
    }
    return false;
}

}  // namespace

bool interiors_meet(const PosedMesh& a, const PosedMesh& b, std::span<const TouchingTriangles> touching,
                    const std::stop_token& stop) {
    if (!a.tree.parts.any_closed && !b.tree.parts.any_closed) return false;
    if (are_separated(a, b, touching)) return false;
    const View of_a{a, b, &TouchingTriangles::a, &TouchingTriangles::b};
    const View of_b{b, a, &TouchingTriangles::b, &TouchingTriangles::a};
    if (part_is_inside(of_a, touching) || part_is_inside(of_b, touching)) return true;
    const std::vector<TouchingTriangles> pairs(touching.begin(), touching.end());
    return faces_meet(of_a, pairs, stop) || faces_meet(of_b, pairs, stop);
}

}  // namespace octopair
