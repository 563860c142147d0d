// Kinds of objects (mesh, convex solid, plane), and for each kind of pair the functions that its tests consist of.
//
// Kinds of pairs  TwoMeshes, TwoSolids, MeshAndSolid, SolidAndPlane, MeshAndPlane. A mesh comes first in its pair, a plane last.
// Functions       meeting(), gap(), find_contacts(), set_contained_depth(), is_separated_by(), overlap_along(), thickness().
//                 is_separated_by(motion): whether the objects do not penetrate if b is moved.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <stop_token>
#include <utility>
#include <variant>

#include "base/test_hooks.hpp"
#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/mesh/mesh_contacts.hpp"
#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/object_pair.hpp"
#include "narrow_phase/plane_pair.hpp"
#include "narrow_phase/thickness/overlap_thickness.hpp"
#include "octopair/collision.hpp"

namespace octopair {

enum class ObjectKind : std::uint8_t { mesh, solid, plane };

inline ObjectKind kind_of(const PosedObject& object) {
    if (std::holds_alternative<shape::Mesh>(object.geometry.shape)) return ObjectKind::mesh;
    return object.geometry.convex.exists() ? ObjectKind::solid : ObjectKind::plane;
}

// Views of an object, borrowed. Each requires that the object is of that kind.

inline PosedMesh mesh_of(const PosedObject& object) { return {*object.geometry.tree, object.pose}; }
inline PosedConvex solid_of(const PosedObject& object) { return {object.geometry.convex, object.pose}; }
inline BoxedSolid boxed_solid_of(const PosedObject& object) {
    return {object.geometry.convex, {*object.geometry.tree, object.pose}};
}
inline PosedPlane plane_of(const PosedObject& object) {
    return posed_plane(std::get<shape::Plane>(object.geometry.shape), object.pose);
}

/// Distance of two objects, the common form of SurfaceGap and ConvexGap.
struct ObjectDistance {
    double distance = 0, at_least = 0;  ///< see ConvexGap
    std::array<Point3d, 2> nearest = {};
};
inline std::optional<ObjectDistance> distance_from(const std::optional<SurfaceGap>& gap) {
    if (!gap) return std::nullopt;
    return ObjectDistance{gap->distance, gap->distance, gap->nearest};
}
inline std::optional<ObjectDistance> distance_from(const std::optional<ConvexGap>& gap) {
    if (!gap) return std::nullopt;
    return ObjectDistance{gap->distance, gap->at_least, {gap->on_a, gap->on_b}};
}

/// Returns a bound on the rounding error of a depth: 1e-12 of the radius of the smaller object's bounding sphere. Convex solids whose
/// depth is at most this bound count as touching.
inline double depth_rounding(const PosedObject& a, const PosedObject& b) {
    const auto size = [](const PosedObject& object) {
        const ShapeBounds& bounds = object.geometry.bounds;
        return bounds.bounded ? bounds.radius : std::numeric_limits<double>::infinity();
    };
    return std::min(size(a), size(b)) * 1e-12;
}

/// Returns the largest error of a depth that still counts as the least depth: 1e-6 of the smaller radius. `rounding`: depth_rounding().
inline double max_depth_error(double rounding) { return 1e6 * rounding; }

inline Contact contact_from(const ConvexContact& contact) { return {contact.point, contact.normal, contact.depth}; }

/// Sets the depth and the single contact of a pair for which one contact is sufficient.
inline void set_single_contact(const Contact& contact, std::uint32_t max_contacts, Finding& finding) {
    finding.depth = contact.depth;
    finding.depth_kind = DepthKind::least;
    finding.more_contacts = max_contacts == 0;
    if (max_contacts > 0) finding.contacts = {contact};
}

/// Sets the class according to the depth. A depth that is within rounding becomes 0.
inline void set_class_by_depth(double rounding, Finding& finding) {
    const bool touches = finding.depth <= rounding || planted(Fault::overlap_called_touching);
    finding.collision_class = touches ? CollisionClass::touching : CollisionClass::penetrating;
    if (!touches) return;
    finding.depth = 0;
    finding.depth_kind = DepthKind::least;
}

/// Class of two objects that meet, contained or collision; nothing if they do not meet.
using Meeting = std::optional<CollisionClass>;

inline Meeting collision_if(bool meet) { return meet ? Meeting(CollisionClass::collision) : std::nullopt; }
inline Meeting contained_or_collision(bool contained) {
    return contained ? CollisionClass::contained : CollisionClass::collision;
}

inline Pose moved_by(Pose pose, const Point3d& by) {
    for (std::size_t axis = 0; axis < 3; ++axis) pose.rows[axis][3] += by[axis];
    return pose;
}

/// Returns the greatest coordinate of the mesh along a direction.
inline double greatest_along(const Point3d& direction, const PosedMesh& mesh) {
    // The direction in the mesh's coordinates, so that vertices need not be posed one by one.
    const Point3d own = vector::turned_back(mesh.pose, direction);
    double most = -std::numeric_limits<double>::infinity();
    for (const Point3d& vertex : mesh.tree.vertices) most = std::max(most, vector::dot(own, vertex));
    return most + vector::dot(direction, vector::place(mesh.pose));
}

inline double greatest_along(const Point3d& direction, const BoxedSolid& solid) {
    const Point3d own = vector::turned_back(solid.box.pose, direction);
    return vector::dot(direction, vector::posed(solid.box.pose, support(solid.solid, own))) + solid.solid.radius;
}

/// Returns how far b must move along `direction` until a plane separates the objects. It is an upper bound of the least separating
/// translation. Requires: `direction` has length 1; the objects are not empty.
inline double overlap_along(const Point3d& direction, const PosedMesh& a, const PosedMesh& b) {
    return greatest_along(direction, a) + greatest_along(vector::times(direction, -1), b);
}

inline double overlap_along(const Point3d& direction, const PosedMesh& a, const BoxedSolid& b) {
    return greatest_along(direction, a) + greatest_along(vector::times(direction, -1), b);
}

struct TwoMeshes {
    PosedMesh a, b;
    double rounding;

    Meeting meeting() const {
        if (surfaces_meet(a, b)) return CollisionClass::collision;
        if (!encloses_part(a, b) && !encloses_part(b, a)) return std::nullopt;
        return contained_or_collision(contains_mesh(a, b) || contains_mesh(b, a));
    }
    std::optional<ObjectDistance> gap(double most) const { return distance_from(surface_gap(a, b, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        ContactRequest with_error = request;
        with_error.max_error = max_depth_error(rounding);
        find_mesh_contacts(a, b, with_error, finding);
    }
    void set_contained_depth(const std::stop_token& stop, Finding& finding) const {
        set_depth_of_meshes(a, b, {.max_contacts = 0, .stop = stop, .max_error = max_depth_error(rounding)}, finding);
    }
    bool is_separated_by(const Point3d& motion, const std::stop_token& stop) const {
        const Pose there = moved_by(b.pose, motion);
        return !meshes_penetrate(a, {b.tree, there}, stop);
    }
    double overlap_along(const Point3d& direction) const { return octopair::overlap_along(direction, a, b); }
    OverlapThickness thickness(double tolerance, const std::stop_token& stop) const {
        if (!a.tree.parts.all_closed() || !b.tree.parts.all_closed()) return {};
        return overlap_thickness(a, b, tolerance, stop);
    }
};

struct TwoSolids {
    PosedConvex a, b;
    double rounding;

    Meeting meeting() const {
        if (!convex_meet(a, b)) return std::nullopt;
        return contained_or_collision(convex_contains(a, b) || convex_contains(b, a));
    }
    std::optional<ObjectDistance> gap(double) const { return distance_from(std::optional(convex_gap(a, b))); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        const ConvexContact contact = convex_contact(a, b);
        set_single_contact(contact_from(contact), request.max_contacts, finding);
        set_class_by_depth(rounding, finding);
    }
    void set_contained_depth(const std::stop_token&, Finding& finding) const {
        finding.depth = convex_contact(a, b).depth;
        finding.depth_kind = DepthKind::least;
    }
    // Never called: the depth is always the least, so object_pair.cpp tries no directions.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }
    static OverlapThickness thickness(double, const std::stop_token&) { return {}; }
};

struct MeshAndSolid {
    PosedMesh mesh;
    BoxedSolid solid;
    double rounding;

    Meeting meeting() const {
        if (surface_meets(mesh, solid)) return contained_or_collision(contains_mesh(solid, mesh));
        return encloses_solid(mesh, solid) ? Meeting(CollisionClass::contained) : std::nullopt;
    }
    std::optional<ObjectDistance> gap(double most) const { return distance_from(surface_gap(mesh, solid, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_solid_contacts(mesh, solid, {request.max_contacts, rounding, max_depth_error(rounding), request.stop},
                                 finding);
        set_class_by_depth(rounding, finding);
    }
    void set_contained_depth(const std::stop_token&, Finding& finding) const {
        set_depth_of_mesh_and_solid(mesh, solid, max_depth_error(rounding), finding);
    }
    bool is_separated_by(const Point3d& motion, const std::stop_token& stop) const {
        const Pose there = moved_by(solid.box.pose, motion);
        const MeshAndSolid pair{mesh, {solid.solid, {solid.box.tree, there}}, rounding};
        const Meeting at = pair.meeting();
        if (at != CollisionClass::collision) return !at;
        Finding finding;
        pair.find_contacts({0, stop}, finding);
        return finding.collision_class == CollisionClass::touching;
    }
    double overlap_along(const Point3d& direction) const { return octopair::overlap_along(direction, mesh, solid); }
    OverlapThickness thickness(double tolerance, const std::stop_token& stop) const {
        if (!mesh.tree.parts.all_closed()) return {};
        return overlap_thickness(mesh, solid, tolerance, stop);
    }
};

struct SolidAndPlane {
    PosedConvex solid;
    PosedPlane plane;
    double rounding;

    PlaneSpan span() const { return span_across(plane, solid); }
    Meeting meeting() const { return collision_if(meets(span())); }
    std::optional<ObjectDistance> gap(double) const {
        auto found = distance_from(std::optional(plane_gap(plane, span())));
        std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        set_plane_contact(plane, span(), request.max_contacts, finding);
        set_class_by_depth(rounding, finding);
    }
    static void set_contained_depth(const std::stop_token&, Finding&) {}
    // Never called: the depth is always the least, so object_pair.cpp tries no directions.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }
    static OverlapThickness thickness(double, const std::stop_token&) { return {}; }

    static void set_plane_contact(const PosedPlane& plane, const PlaneSpan& span, std::uint32_t max_contacts,
                                  Finding& finding) {
        Contact contact = contact_from(plane_contact(plane, span));
        contact.normal = vector::times(contact.normal, -1);
        set_single_contact(contact, max_contacts, finding);
    }
};

struct MeshAndPlane {
    PosedMesh mesh;
    PosedPlane plane;
    double rounding;

    Meeting meeting() const { return collision_if(surface_meets(mesh, plane)); }
    std::optional<ObjectDistance> gap(double) const {
        auto found = distance_from(plane_gap(plane, mesh));
        if (found) std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        SolidAndPlane::set_plane_contact(plane, *span_across(plane, mesh), request.max_contacts, finding);
        set_class_by_depth(rounding, finding);
    }
    static void set_contained_depth(const std::stop_token&, Finding&) {}
    // Never called: the depth is always the least, so object_pair.cpp tries no directions.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }
    static OverlapThickness thickness(double, const std::stop_token&) { return {}; }
};

/// Makes the pair of the two objects, of one of the kinds above, and returns judge(pair). Returns `of_planes` for two planes.
/// Requires: the kind of `first` is not after the kind of `second`.
template <typename Result, typename Judge>
Result with_kind(const PosedObject& first, const PosedObject& second, Result of_planes, const Judge& judge) {
    const double rounding = depth_rounding(first, second);
    const ObjectKind a = kind_of(first), b = kind_of(second);
    if (a == ObjectKind::mesh && b == ObjectKind::mesh)
        return judge(TwoMeshes{mesh_of(first), mesh_of(second), rounding});
    if (a == ObjectKind::mesh && b == ObjectKind::solid)
        return judge(MeshAndSolid{mesh_of(first), boxed_solid_of(second), rounding});
    if (a == ObjectKind::mesh) return judge(MeshAndPlane{mesh_of(first), plane_of(second), rounding});
    if (b == ObjectKind::solid) return judge(TwoSolids{solid_of(first), solid_of(second), rounding});
    if (a == ObjectKind::solid) return judge(SolidAndPlane{solid_of(first), plane_of(second), rounding});
    return of_planes;
}

}  // namespace octopair
