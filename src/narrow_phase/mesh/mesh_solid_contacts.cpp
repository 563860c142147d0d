// Contacts of a mesh and a convex solid that meet: depth and contacts.
//
// Depth     Of a convex mesh: the least translation that separates the solids. Of others a lower bound: the largest penetration
//           depth of a triangle in the solid or, if that is larger, the depth of the deepest sample of one object inside the
//           other.
// Samples   Corners and centroids of triangles; the middle of the solid and its support points in 14 directions; of a hull
//           also the middles between contacts.
// Contacts  One for each triangle that meets the solid, with the shortest translation that separates the two. For a closed
//           mesh the translation of the solid leads out of the mesh, never into it. Sorted by descending depth, then by the
//           number of the triangle. Of more than max_contacts, the first ones in this order are kept; no more are in memory.
#include "narrow_phase/mesh/mesh_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/mesh/deepest_contacts.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/mesh_probe.hpp"
#include "narrow_phase/plane_pair.hpp"

namespace octopair {

namespace {

/// Maximum number of contact points, and about the maximum number of hull points, whose middles are tested as samples.
constexpr std::size_t most_samples = 16;

/// Returns a point deep inside the core: the mean of its points, or the origin of its coordinates.
Point3d deep_place_of(const ConvexSolid& solid) {
    Point3d middle = {};
    for (const Point3d& point : solid.points) {
        middle = vector::plus(middle, vector::times(point, 1 / double(solid.points.size())));
    }
    return middle;
}

/// Returns samples of the core in the world: its middle, and the support points along the 6 axis and 8 diagonal directions.
std::vector<Point3d> places_of(const BoxedSolid& solid) {
    std::vector<Point3d> places = {vector::posed(solid.box.pose, deep_place_of(solid.solid))};
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                const int along = std::abs(x) + std::abs(y) + std::abs(z);
                if (along != 1 && along != 3) continue;
                const Point3d direction = {double(x), double(y), double(z)};
                places.push_back(vector::posed(solid.box.pose, support(solid.solid, direction)));
            }
        }
    }
    return places;
}

/// Returns the depth in the mesh of the deepest of `places`, which are points of the core. `radius`: radius around the core.
double deepest_in_mesh(const PosedMesh& mesh, double radius, const std::vector<Point3d>& places) {
    SurfaceProbe probe(mesh);
    double deepest = 0;
    for (const Point3d& place : places) {
        const double distance = probe.distance(place, 0);
        if (distance > 0 && encloses(mesh, place)) deepest = std::max(deepest, distance + radius);
    }
    return deepest;
}

/// Returns the contact points of some of the `count` triangles that meet the solid, at a fixed stride. Ends early after a stop request.
std::vector<Point3d> some_contact_points(const PosedMesh& mesh, const BoxedSolid& solid, std::size_t count,
                                         const std::stop_token& stop) {
    std::vector<Point3d> points;
    const std::size_t step = count / most_samples + 1;
    std::size_t i = 0;
    visit_meeting_triangles(mesh, solid, [&](std::uint32_t, const Triangle3d& triangle) {
        if (i++ % step == 0) points.push_back(convex_contact(PosedConvex(triangle), solid.posed()).point);
        return !stop.stop_requested();
    });
    return points;
}

/// Returns the middles between each two of some points: `points`, which are contact points, and some points of the hull. A flat hull may
/// pass through a mesh while all its own points are outside. Then only points between them are inside.
std::vector<Point3d> middles_of(const BoxedSolid& solid, std::vector<Point3d> points) {
    const std::vector<Point3d>& own = solid.solid.points;
    for (std::size_t i = 0; i < own.size(); i += own.size() / most_samples + 1) {
        points.push_back(vector::posed(solid.box.pose, own[i]));
    }
    std::vector<Point3d> middles;
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) middles.push_back(vector::times(vector::plus(points[i], points[k]), 0.5));
    }
    return middles;
}

/// Returns the depth of the deepest corner or centroid in the solid. Tests at most about 1024 triangles, at a fixed stride.
double deepest_in_solid(const PosedMesh& mesh, const BoxedSolid& solid) {
    constexpr std::size_t max_triangles = 1024;
    const std::size_t step = mesh.tree.triangles.size() / max_triangles + 1;
    double deepest = 0;
    const auto test_place = [&](const Point3d& place) {
        const PosedConvex point(place);
        if (convex_meet(point, solid.posed())) deepest = std::max(deepest, convex_contact(point, solid.posed()).depth);
    };
    for (std::size_t i = 0; i < mesh.tree.triangles.size(); i += step) {
        const Triangle3d triangle = mesh.tree.world_triangle(mesh.pose, std::uint32_t(i));
        test_place(triangle[0]);  // the other corners are mostly first corners of other triangles
        test_place(middle_of(triangle));
    }
    return deepest;
}

/// Returns the outward normal of an oriented triangle, with length 1; 0 for a degenerate triangle. Accounts for poses that
/// mirror.
Point3d outward_of(const Triangle3d& triangle, const Pose& pose) {
    const Point3d normal =
        vector::cross(vector::minus(triangle[1], triangle[0]), vector::minus(triangle[2], triangle[0]));
    const double length = vector::length(normal);
    if (!(length > 0)) return {};
    return vector::times(normal, (mirrors(pose) ? -1 : 1) / length);
}

/// Replaces a contact whose normal leads into the mesh by one along the triangle's outward normal.
void turn_outward(const Triangle3d& triangle, const Point3d& outward, const BoxedSolid& solid, Contact& contact) {
    if (vector::dot(contact.normal, outward) >= 0) return;
    contact.normal = outward;
    const PosedPlane side{outward, triangle[0]};
    contact.depth = std::max(0.0, -height_above(side, span_across(side, solid.posed()).lowest));
}

}  // namespace

void set_depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid, double max_error, Finding& finding) {
    if (is_solid(mesh, max_error)) {
        finding.depth = convex_contact({mesh.tree.solid, mesh.pose}, solid.posed()).depth;
        finding.depth_kind = DepthKind::least;
        return;
    }
    finding.depth = deepest_in_solid(mesh, solid);
    finding.depth_kind = DepthKind::at_least;
    if (!mesh.tree.parts.any_closed) return;
    finding.depth = std::max(finding.depth, deepest_in_mesh(mesh, solid.solid.radius, places_of(solid)));
}

void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding) {
    DeepestContacts contacts(request.max_contacts);
    double deepest = 0;
    std::size_t count = 0;
    visit_meeting_triangles(mesh, solid, [&](std::uint32_t at, const Triangle3d& triangle) {
        const bool oriented = mesh.tree.parts.sides[at] == MeshParts::Side::oriented;
        const Point3d outward = oriented ? outward_of(triangle, mesh.pose) : Point3d{};
        const ConvexContact least = convex_contact(PosedConvex(triangle), solid.posed());
        Contact contact = {least.point, least.normal, least.depth, mesh.tree.numbers[at]};
        deepest = std::max(deepest, least.depth);
        if (least.depth > request.touching_depth) turn_outward(triangle, outward, solid, contact);
        contacts.add(contact);
        ++count;
        return !request.stop.stop_requested();
    });
    if (request.stop.stop_requested()) return;  // `count` and the contacts are incomplete
    // First uses only an exact solid: a solid with errors may tell how deep the objects meet, but not whether their interiors meet.
    set_depth_of_mesh_and_solid(mesh, solid, 0, finding);
    if (finding.depth_kind == DepthKind::at_least) finding.depth = std::max(finding.depth, deepest);
    const bool hull = solid.solid.core == ConvexSolid::Core::points && solid.solid.radius == 0;
    if (finding.depth <= request.touching_depth && hull && mesh.tree.parts.any_closed) {
        finding.depth =
            deepest_in_mesh(mesh, 0, middles_of(solid, some_contact_points(mesh, solid, count, request.stop)));
        finding.depth_kind = DepthKind::at_least;
    }
    if (finding.depth > request.touching_depth && finding.depth_kind == DepthKind::at_least &&
        is_solid(mesh, request.max_error)) {
        set_depth_of_mesh_and_solid(mesh, solid, request.max_error, finding);
    }
    contacts.give(finding);
}

}  // namespace octopair
