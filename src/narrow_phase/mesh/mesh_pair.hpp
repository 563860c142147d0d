// Two posed meshes: whether they meet, which triangles meet, whether one lies inside the other, and their distance.
//
// The exact triangle test decides, on the triangles' world coordinates (shapes.hpp). The bounding hierarchies only skip pairs
// that cannot change the result. So the result equals that of testing all pairs of triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "geometry/vector.hpp"
#include "narrow_phase/exact/nearby_point.hpp"
#include "narrow_phase/exact/orientation.hpp"
#include "narrow_phase/mesh/mesh_tree.hpp"

namespace octopair {

struct PosedMesh {
    const MeshTree& tree;
    const Pose& pose;
};

/// Returns true if the determinant of the pose's linear part is negative. A pose that flattens does not mirror.
/// Triangles that are counterclockwise from outside are clockwise in the world if the pose mirrors.
inline bool mirrors(const Pose& pose) {
    return plane_side({0, 0, 0}, vector::column(pose, 0), vector::column(pose, 1), vector::column(pose, 2)) < 0;
}

/// Returns whether MeshTree::solid may stand for the mesh: it exists, and in the world it errs by at most `max_error`.
inline bool is_solid(const PosedMesh& mesh, double max_error) {
    if (!mesh.tree.solid.exists() || mesh.tree.solid_error == 0) return mesh.tree.solid.exists();
    double scale = 0;
    for (std::size_t k = 0; k < 3; ++k) scale = std::max(scale, vector::length(vector::column(mesh.pose, k)));
    return 2 * scale * mesh.tree.solid_error <= max_error;
}

/// Returns true if some triangle of a meets some triangle of b. Only the surfaces count, not the enclosed space.
bool surfaces_meet(const PosedMesh& a, const PosedMesh& b);

/// Two triangles that meet.
struct MeetingTriangles {
    std::uint32_t place_a, place_b;    ///< in the trees' order
    std::uint32_t number_a, number_b;  ///< indices in the given meshes
    const Triangle3d& a;               ///< in the world
    const Triangle3d& b;
};
/// Calls `visit` for each pair of triangles that meet, in an order that depends only on meshes and poses. Ends when `visit`
/// returns false.
void visit_meeting_triangles(const PosedMesh& a, const PosedMesh& b,
                             const std::function<bool(const MeetingTriangles&)>& visit);

/// Returns true if the point is inside the mesh: the winding number of the closed, oriented parts is not 0, or an odd number of
/// closed parts without a consistent orientation contains the point. Requires: the point is not on the surface.
bool encloses(const PosedMesh& mesh, const Point3d& point);
/// Returns true if a point infinitesimally near a place is inside the mesh. The place may be on the surface.
bool encloses(const PosedMesh& mesh, const NearbyPoint& point);

/// Returns true if some part of `inner` lies inside `outer`. Requires: the surfaces do not meet.
bool encloses_part(const PosedMesh& outer, const PosedMesh& inner);

/// Returns true if all of `inner`, with the space that it encloses, lies inside `outer`. Requires: the surfaces do not meet.
bool contains_mesh(const PosedMesh& outer, const PosedMesh& inner);

struct SurfaceGap {
    double distance;
    std::array<Point3d, 2> nearest;
    std::uint32_t number_a, number_b;  ///< indices of the nearest triangles in the given meshes
};
/// Returns the distance of the surfaces if it is at most `most`, otherwise nothing.
std::optional<SurfaceGap> surface_gap(const PosedMesh& a, const PosedMesh& b, double most);

}  // namespace octopair
