#include "narrow_phase/mesh/mesh_solid_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_plane.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/mesh_probe.hpp"

namespace octopair {

namespace {

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

double deepest_in_mesh(const PosedMesh& mesh, const BoxedSolid& solid) {
    SurfaceProbe probe(mesh);
    double deepest = 0;
    for (const Point3d& place : places_of(solid)) {
        const double distance = probe.distance(place, 0);
        if (distance > 0 && encloses(mesh, place)) deepest = std::max(deepest, distance + solid.solid.radius);
    }
    return deepest;
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
        test_place(triangle[0]);  // other corners are first corners of neighbours
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

double depth_of_mesh_and_solid(const PosedMesh& mesh, const BoxedSolid& solid) {
    const double in_solid = deepest_in_solid(mesh, solid);
    return mesh.tree.parts.any_closed ? std::max(in_solid, deepest_in_mesh(mesh, solid)) : in_solid;
}

void find_mesh_solid_contacts(const PosedMesh& mesh, const BoxedSolid& solid, const MeshSolidRequest& request,
                              Finding& finding) {
    double deepest = 0;
    visit_meeting_triangles(mesh, solid, [&](std::uint32_t at, const Triangle3d& triangle) {
        const bool oriented = mesh.tree.parts.sides[at] == MeshParts::Side::oriented;
        const Point3d outward = oriented ? outward_of(triangle, mesh.pose) : Point3d{};
        const ConvexContact least = convex_contact(PosedConvex(triangle), solid.posed());
        Contact contact = {least.point, least.normal, least.depth, mesh.tree.numbers[at]};
        deepest = std::max(deepest, least.depth);
        if (least.depth > request.touching_depth) turn_outward(triangle, outward, solid, contact);
        finding.contacts.push_back(contact);
        return !request.stop.stop_requested();
    });
    const double inside = mesh.tree.parts.any_closed ? depth_of_mesh_and_solid(mesh, solid) : 0;
    finding.depth = std::max(inside, deepest);
    std::sort(finding.contacts.begin(), finding.contacts.end(), [](const Contact& a, const Contact& b) {
        return a.depth != b.depth ? a.depth > b.depth : a.feature_a < b.feature_a;
    });
}

}  // namespace octopair
