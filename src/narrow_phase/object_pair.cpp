#include "narrow_phase/object_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/mesh/mesh_contacts.hpp"
#include "narrow_phase/mesh/mesh_convex.hpp"
#include "narrow_phase/mesh/mesh_pair.hpp"
#include "narrow_phase/mesh/mesh_plane.hpp"
#include "narrow_phase/mesh/mesh_solid_contacts.hpp"
#include "narrow_phase/object_kind.hpp"

namespace octopair {

namespace {

/// Distance of two objects, the common form of SurfaceGap and ConvexGap.
struct Distance {
    double distance = 0, at_least = 0;  ///< see ConvexGap
    std::array<Point3d, 2> nearest = {};
};
std::optional<Distance> from(const std::optional<SurfaceGap>& gap) {
    if (!gap) return std::nullopt;
    return Distance{gap->distance, gap->distance, gap->nearest};
}
std::optional<Distance> from(const std::optional<ConvexGap>& gap) {
    if (!gap) return std::nullopt;
    return Distance{gap->distance, gap->at_least, {gap->on_a, gap->on_b}};
}

/// Returns the largest depth that counts as touching: a fraction of the smaller object's size. The fraction is larger if an
/// object is curved, because its depth is less accurate.
double touching_depth_of(const PosedObject& a, const PosedObject& b) {
    const auto size = [](const PosedObject& object) {
        const ShapeBounds& bounds = object.geometry.bounds;
        return bounds.bounded ? bounds.radius : std::numeric_limits<double>::infinity();
    };
    const auto curved = [](const PosedObject& object) {
        const ConvexSolid& solid = object.geometry.convex;
        return solid.radius > 0 || (solid.core != ConvexSolid::Core::points && solid.core != ConvexSolid::Core::box);
    };
    return std::min(size(a), size(b)) * (curved(a) || curved(b) ? 1e-9 : 1e-12);
}

Contact from(const ConvexContact& contact) { return {contact.point, contact.normal, contact.depth}; }

/// Sets the depth and the single contact of a pair for which one contact is sufficient.
void set_contact(const Contact& contact, std::uint32_t max_contacts, Finding& finding) {
    finding.depth = contact.depth;
    finding.more_contacts = max_contacts == 0;
    if (max_contacts > 0) finding.contacts = {contact};
}

/// Sets the class according to the depth. A depth that counts as touching becomes 0.
void set_class(double touching_depth, Finding& finding) {
    const bool touches = finding.depth <= touching_depth;
    finding.collision_class = touches ? CollisionClass::touching : CollisionClass::penetrating;
    if (touches) finding.depth = 0;
}

/// Class of two objects that meet, contained or collision; nothing if they do not meet.
using Meeting = std::optional<CollisionClass>;

Meeting collision_if(bool meet) { return meet ? Meeting(CollisionClass::collision) : std::nullopt; }
Meeting contained_or_collision(bool contained) {
    return contained ? CollisionClass::contained : CollisionClass::collision;
}

// Kinds of pairs. Each has the same functions: meeting(), gap(), find_contacts(), contained_depth(). A mesh comes first in its
// pair, a plane last.

struct TwoMeshes {
    PosedMesh a, b;

    Meeting meeting() const {
        if (surfaces_meet(a, b)) return CollisionClass::collision;
        if (!encloses_part(a, b) && !encloses_part(b, a)) return std::nullopt;
        return contained_or_collision(contains_mesh(a, b) || contains_mesh(b, a));
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(a, b, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_contacts(a, b, request, finding);
    }
    double contained_depth(const std::stop_token& stop) const { return depth_of_meshes(a, b, stop); }
};

struct TwoSolids {
    PosedConvex a, b;
    double touching_depth;

    Meeting meeting() const {
        if (!convex_meet(a, b)) return std::nullopt;
        return contained_or_collision(convex_contains(a, b) || convex_contains(b, a));
    }
    std::optional<Distance> gap(double) const { return from(std::optional(convex_gap(a, b))); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        const ConvexContact contact = convex_contact(a, b);
        set_contact(from(contact), request.max_contacts, finding);
        set_class(touching_depth, finding);
    }
    double contained_depth(const std::stop_token&) const { return convex_contact(a, b).depth; }
};

struct MeshAndSolid {
    PosedMesh mesh;
    BoxedSolid solid;
    double touching_depth;

    Meeting meeting() const {
        if (surface_meets(mesh, solid)) return contained_or_collision(contains_mesh(solid, mesh));
        return encloses_solid(mesh, solid) ? Meeting(CollisionClass::contained) : std::nullopt;
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(mesh, solid, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_solid_contacts(mesh, solid, {touching_depth, request.stop}, finding);
        set_class(touching_depth, finding);
        finding.more_contacts = finding.contacts.size() > request.max_contacts;
        if (finding.more_contacts) finding.contacts.resize(request.max_contacts);
    }
    double contained_depth(const std::stop_token&) const { return depth_of_mesh_and_solid(mesh, solid); }
};

struct SolidAndPlane {
    PosedConvex solid;
    PosedPlane plane;
    double touching_depth;

    PlaneSpan span() const { return span_across(plane, solid); }
    Meeting meeting() const { return collision_if(meets(span())); }
    std::optional<Distance> gap(double) const {
        auto found = from(std::optional(plane_gap(plane, span())));
        std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        set_plane_contact(plane, span(), request.max_contacts, finding);
        set_class(touching_depth, finding);
    }
    static double contained_depth(const std::stop_token&) { return 0; }

    static void set_plane_contact(const PosedPlane& plane, const PlaneSpan& span, std::uint32_t max_contacts,
                                  Finding& finding) {
        Contact contact = from(plane_contact(plane, span));
        contact.normal = vector::times(contact.normal, -1);
        set_contact(contact, max_contacts, finding);
    }
};

struct MeshAndPlane {
    PosedMesh mesh;
    PosedPlane plane;
    double touching_depth;

    Meeting meeting() const { return collision_if(surface_meets(mesh, plane)); }
    std::optional<Distance> gap(double) const {
        auto found = from(plane_gap(plane, mesh));
        if (found) std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        SolidAndPlane::set_plane_contact(plane, *span_across(plane, mesh), request.max_contacts, finding);
        set_class(touching_depth, finding);
    }
    static double contained_depth(const std::stop_token&) { return 0; }
};

/// Returns judge(pair), where pair is one of the kinds above; `of_planes` for two planes.
/// Requires: the kind of `first` is not after the kind of `second`.
template <typename Result, typename Judge>
Result with_kind(const PosedObject& first, const PosedObject& second, Result of_planes, const Judge& judge) {
    const double touching_depth = touching_depth_of(first, second);
    const Kind a = kind_of(first), b = kind_of(second);
    if (a == Kind::mesh && b == Kind::mesh) return judge(TwoMeshes{mesh_of(first), mesh_of(second)});
    if (a == Kind::mesh && b == Kind::solid)
        return judge(MeshAndSolid{mesh_of(first), boxed_solid_of(second), touching_depth});
    if (a == Kind::mesh) return judge(MeshAndPlane{mesh_of(first), plane_of(second), touching_depth});
    if (b == Kind::solid) return judge(TwoSolids{solid_of(first), solid_of(second), touching_depth});
    if (a == Kind::solid) return judge(SolidAndPlane{solid_of(first), plane_of(second), touching_depth});
    return of_planes;
}

/// Returns `reach`, enlarged so that a distance equal to `reach` up to rounding counts.
double room_for_rounding(double reach) { return reach * (1 + 1e-12); }

/// Converts a finding to the other order of the two objects.
void swap_objects(Finding& finding) {
    std::swap(finding.nearest[0], finding.nearest[1]);
    for (Contact& contact : finding.contacts) {
        contact.normal = vector::times(contact.normal, -1);
        std::swap(contact.feature_a, contact.feature_b);
    }
}

template <typename Pair>
bool judge_pair(const Pair& pair, double reach, Finding& finding) {
    if (const Meeting meeting = pair.meeting()) {
        finding.collision_class = *meeting;
        return true;
    }
    if (!(reach > 0)) return false;
    const double most = room_for_rounding(reach);
    const std::optional<Distance> gap = pair.gap(most);
    if (!gap || gap->at_least > most) return false;
    finding.collision_class = CollisionClass::clearance;
    finding.distance = gap->distance;
    finding.nearest = gap->nearest;
    return true;
}

}  // namespace

bool judge_objects(const PosedObject& a, const PosedObject& b, double reach, Finding& finding) {
    const bool in_order = kind_of(a) <= kind_of(b);
    const bool counts = with_kind(in_order ? a : b, in_order ? b : a, false,
                                  [&](const auto& pair) { return judge_pair(pair, reach, finding); });
    if (!in_order) swap_objects(finding);
    return counts;
}

std::optional<ObjectGap> object_gap(const PosedObject& a, const PosedObject& b) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const bool in_order = kind_of(a) <= kind_of(b);
    using Answer = std::optional<ObjectGap>;
    Answer gap = with_kind(in_order ? a : b, in_order ? b : a, Answer(), [&](const auto& pair) -> Answer {
        if (pair.meeting()) return ObjectGap();
        const std::optional<Distance> found = pair.gap(infinity);
        if (!found) return std::nullopt;
        return ObjectGap{found->at_least, found->nearest};
    });
    if (gap && !in_order) std::swap(gap->nearest[0], gap->nearest[1]);
    return gap;
}

void find_contacts(const PosedObject& a, const PosedObject& b, const ContactRequest& request, Finding& finding) {
    const bool in_order = kind_of(a) <= kind_of(b);
    if (!in_order) swap_objects(finding);
    with_kind(in_order ? a : b, in_order ? b : a, 0, [&](const auto& pair) {
        if (finding.collision_class == CollisionClass::contained) {
            finding.depth = pair.contained_depth(request.stop);
        } else {
            pair.find_contacts(request, finding);
        }
        return 0;
    });
    if (!in_order) swap_objects(finding);
}

}  // namespace octopair
