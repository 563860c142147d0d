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

/// What each kind of pair is asked.
struct Distance {
    double distance = 0, at_least = 0;  ///< as ConvexGap has them
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

/// A depth of at most this is a touch: a part of the smaller one's size, as what is curved is known no better.
double touch_of(const PosedObject& a, const PosedObject& b) {
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

/// One contact says it all.
void set_contact(const Contact& contact, std::uint32_t max_contacts, Finding& finding) {
    finding.depth = contact.depth;
    finding.more_contacts = max_contacts == 0;
    if (max_contacts > 0) finding.contacts = {contact};
}

/// By the depth, which of those that touch is none.
void set_class(double touch, Finding& finding) {
    const bool touches = finding.depth <= touch;
    finding.collision_class = touches ? CollisionClass::touching : CollisionClass::penetrating;
    if (touches) finding.depth = 0;
}

/// Of two that meet: whether one contains the other; nothing of two that do not.
using Meeting = std::optional<CollisionClass>;

Meeting collision_if(bool meet) { return meet ? Meeting(CollisionClass::collision) : std::nullopt; }
Meeting contained_or_collision(bool contained) {
    return contained ? CollisionClass::contained : CollisionClass::collision;
}

// The kinds of pairs: each says whether the two meet, how far apart they are, and how they meet. Those of a mesh have it
// first, those of a plane last.

struct TwoMeshes {
    PosedMesh a, b;

    Meeting meeting() const {
        if (surfaces_meet(a, b)) return CollisionClass::collision;
        if (!encloses_part(a, b) && !encloses_part(b, a)) return std::nullopt;
        return contained_or_collision(holds_whole(a, b) || holds_whole(b, a));
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(a, b, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_contacts(a, b, request, finding);
    }
    double contained_depth(const std::stop_token& stop) const { return depth_of_meshes(a, b, stop); }
};

struct TwoSolids {
    PosedConvex a, b;
    double touch;

    Meeting meeting() const {
        if (!convex_meet(a, b)) return std::nullopt;
        return contained_or_collision(convex_contains(a, b) || convex_contains(b, a));
    }
    std::optional<Distance> gap(double) const { return from(std::optional(convex_gap(a, b))); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        const ConvexContact contact = convex_contact(a, b);
        set_contact(from(contact), request.max_contacts, finding);
        set_class(touch, finding);
    }
    double contained_depth(const std::stop_token&) const { return convex_contact(a, b).depth; }
};

struct MeshAndSolid {
    PosedMesh mesh;
    BoxedSolid solid;
    double touch;

    Meeting meeting() const {
        if (surface_meets(mesh, solid)) return contained_or_collision(holds_mesh(solid, mesh));
        return encloses_solid(mesh, solid) ? Meeting(CollisionClass::contained) : std::nullopt;
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(mesh, solid, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_solid_contacts(mesh, solid, {touch, request.stop}, finding);
        set_class(touch, finding);
        finding.more_contacts = finding.contacts.size() > request.max_contacts;
        if (finding.more_contacts) finding.contacts.resize(request.max_contacts);
    }
    double contained_depth(const std::stop_token&) const { return depth_of_mesh_and_solid(mesh, solid); }
};

struct SolidAndPlane {
    PosedConvex solid;
    PosedPlane plane;
    double touch;

    PlaneSpan span() const { return span_across(plane, solid); }
    Meeting meeting() const { return collision_if(meets(span())); }
    std::optional<Distance> gap(double) const {
        auto found = from(std::optional(plane_gap(plane, span())));
        std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        set_plane_contact(plane, span(), request.max_contacts, finding);
        set_class(touch, finding);
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
    double touch;

    Meeting meeting() const { return collision_if(surface_meets(mesh, plane)); }
    std::optional<Distance> gap(double) const {
        auto found = from(plane_gap(plane, mesh));
        if (found) std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        SolidAndPlane::set_plane_contact(plane, *span_across(plane, mesh), request.max_contacts, finding);
        set_class(touch, finding);
    }
    static double contained_depth(const std::stop_token&) { return 0; }
};

/// Calls judge(pair) with the two as one of the kinds above, `first` being of no later kind than `second`. Planes are
/// apart.
template <typename Result, typename Judge>
Result with_kind(const PosedObject& first, const PosedObject& second, Result of_planes, const Judge& judge) {
    const double touch = touch_of(first, second);
    const Kind a = kind_of(first), b = kind_of(second);
    if (a == Kind::mesh && b == Kind::mesh) return judge(TwoMeshes{mesh_of(first), mesh_of(second)});
    if (a == Kind::mesh && b == Kind::solid) return judge(MeshAndSolid{mesh_of(first), boxed_solid_of(second), touch});
    if (a == Kind::mesh) return judge(MeshAndPlane{mesh_of(first), plane_of(second), touch});
    if (b == Kind::solid) return judge(TwoSolids{solid_of(first), solid_of(second), touch});
    if (a == Kind::solid) return judge(SolidAndPlane{solid_of(first), plane_of(second), touch});
    return of_planes;
}

/// Some more than `reach`: what is as far as that within rounding counts.
double room_for_rounding(double reach) { return reach * (1 + 1e-12); }

/// What was found with the objects in the other order.
void turn_round(Finding& finding) {
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
    if (!in_order) turn_round(finding);
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
    if (!in_order) turn_round(finding);
    with_kind(in_order ? a : b, in_order ? b : a, 0, [&](const auto& pair) {
        if (finding.collision_class == CollisionClass::contained) {
            finding.depth = pair.contained_depth(request.stop);
        } else {
            pair.find_contacts(request, finding);
        }
        return 0;
    });
    if (!in_order) turn_round(finding);
}

}  // namespace octopair
