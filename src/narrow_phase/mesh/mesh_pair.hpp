// Two posed meshes: whether they meet, where, and how far apart they are.
//
// What meets is judged on the triangles' places in the world (shapes.hpp) by the exact test of triangles; the hierarchies
// only leave out what cannot matter. So the answer is that of testing all pairs of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "narrow_phase/mesh/mesh_tree.hpp"

namespace octopair {

struct PosedMesh {
    const MeshTree& tree;
    const Pose& pose;
};

/// Whether some triangle of the one meets one of the other: their surfaces, not what they enclose.
bool surfaces_meet(const PosedMesh& a, const PosedMesh& b);

/// Two triangles that meet: by their numbers in the meshes as they were given, and in the world.
struct MeetingTriangles {
    std::uint32_t number_a, number_b;
    const Triangle3d& a;
    const Triangle3d& b;
    bool both_oriented;  ///< parts of closed surfaces that know their outside
};
/// Tells of all pairs of triangles that meet, in an order that depends on meshes and poses alone. Ends where `tell` returns
/// false.
void visit_meeting_triangles(const PosedMesh& a, const PosedMesh& b,
                             const std::function<bool(const MeetingTriangles&)>& tell);

/// Whether a point that is not on the surface lies inside: in a closed part whose surface winds around it; of parts whose
/// triangles do not agree which side is out, in an odd number.
bool encloses(const PosedMesh& mesh, const Point3d& point);

/// Whether a part of `inner` lies inside `outer`; their surfaces must not meet.
bool encloses_part(const PosedMesh& outer, const PosedMesh& inner);

/// Whether all of `inner`, with what it encloses, lies inside `outer`; their surfaces must not meet.
bool holds_whole(const PosedMesh& outer, const PosedMesh& inner);

struct SurfaceGap {
    double distance;
    std::array<Point3d, 2> nearest;
    std::uint32_t number_a, number_b;  ///< the triangles
};
/// The distance of the surfaces if it is at most `most`, else nothing.
std::optional<SurfaceGap> surface_gap(const PosedMesh& a, const PosedMesh& b, double most);

}  // namespace octopair
