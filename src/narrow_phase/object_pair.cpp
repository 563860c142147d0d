#include "narrow_phase/object_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "base/test_hooks.hpp"
#include "geometry/vector.hpp"
#include "narrow_phase/convex/convex_pair.hpp"
#include "narrow_phase/depth_bounds.hpp"
#include "narrow_phase/duplicates.hpp"
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

/// Returns a bound on the rounding of a depth, as a fraction of the smaller object's size. A depth of convex solids that is no larger
/// counts as touching.
double rounding_of(const PosedObject& a, const PosedObject& b) {
    const auto size = [](const PosedObject& object) {
        const ShapeBounds& bounds = object.geometry.bounds;
        return bounds.bounded ? bounds.radius : std::numeric_limits<double>::infinity();
    };
    return std::min(size(a), size(b)) * 1e-12;
}

/// Returns the largest error of a depth that counts as the least: a millionth of the smaller object's size.
double max_error(double rounding) { return 1e6 * rounding; }

Contact from(const ConvexContact& contact) { return {contact.point, contact.normal, contact.depth}; }

/// Sets the depth and the single contact of a pair for which one contact is sufficient.
void set_contact(const Contact& contact, std::uint32_t max_contacts, Finding& finding) {
    finding.depth = contact.depth;
    finding.depth_kind = DepthKind::least;
    finding.more_contacts = max_contacts == 0;
    if (max_contacts > 0) finding.contacts = {contact};
}

/// Sets the class according to the depth. A depth that is within rounding becomes 0.
void set_class(double rounding, Finding& finding) {
    const bool touches = finding.depth <= rounding || planted(Fault::overlap_called_touching);
    finding.collision_class = touches ? CollisionClass::touching : CollisionClass::penetrating;
    if (!touches) return;
    finding.depth = 0;
    finding.depth_kind = DepthKind::least;
}

/// Class of two objects that meet, contained or collision; nothing if they do not meet.
using Meeting = std::optional<CollisionClass>;

Meeting collision_if(bool meet) { return meet ? Meeting(CollisionClass::collision) : std::nullopt; }
Meeting contained_or_collision(bool contained) {
    return contained ? CollisionClass::contained : CollisionClass::collision;
}

Pose moved(Pose pose, const Point3d& by) {
    for (std::size_t axis = 0; axis < 3; ++axis) pose.rows[axis][3] += by[axis];
    return pose;
}

// Kinds of pairs. Each has the same functions: meeting(), gap(), find_contacts(), set_contained_depth(), is_separated_by(),
// overlap_along(). A mesh comes first in its pair, a plane last. is_separated_by(motion): whether the objects do not penetrate if b
// is moved.

struct TwoMeshes {
    PosedMesh a, b;
    double rounding;

    Meeting meeting() const {
        if (surfaces_meet(a, b)) return CollisionClass::collision;
        if (!encloses_part(a, b) && !encloses_part(b, a)) return std::nullopt;
        return contained_or_collision(contains_mesh(a, b) || contains_mesh(b, a));
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(a, b, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        ContactRequest with_error = request;
        with_error.max_error = max_error(rounding);
        find_mesh_contacts(a, b, with_error, finding);
    }
    void set_contained_depth(const std::stop_token& stop, Finding& finding) const {
        set_depth_of_meshes(a, b, {.max_contacts = 0, .stop = stop, .max_error = max_error(rounding)}, finding);
    }
    bool is_separated_by(const Point3d& motion, const std::stop_token& stop) const {
        const Pose there = moved(b.pose, motion);
        return !meshes_penetrate(a, {b.tree, there}, stop);
    }
    double overlap_along(const Point3d& direction) const { return octopair::overlap_along(direction, a, b); }
};

struct TwoSolids {
    PosedConvex a, b;
    double rounding;

    Meeting meeting() const {
        if (!convex_meet(a, b)) return std::nullopt;
        return contained_or_collision(convex_contains(a, b) || convex_contains(b, a));
    }
    std::optional<Distance> gap(double) const { return from(std::optional(convex_gap(a, b))); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        const ConvexContact contact = convex_contact(a, b);
        set_contact(from(contact), request.max_contacts, finding);
        set_class(rounding, finding);
    }
    void set_contained_depth(const std::stop_token&, Finding& finding) const {
        finding.depth = convex_contact(a, b).depth;
        finding.depth_kind = DepthKind::least;
    }
    // The depth is the least, so these are not needed.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }
};

struct MeshAndSolid {
    PosedMesh mesh;
    BoxedSolid solid;
    double rounding;

    Meeting meeting() const {
        if (surface_meets(mesh, solid)) return contained_or_collision(contains_mesh(solid, mesh));
        return encloses_solid(mesh, solid) ? Meeting(CollisionClass::contained) : std::nullopt;
    }
    std::optional<Distance> gap(double most) const { return from(surface_gap(mesh, solid, most)); }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        find_mesh_solid_contacts(mesh, solid, {request.max_contacts, rounding, max_error(rounding), request.stop},
                                 finding);
        set_class(rounding, finding);
    }
    void set_contained_depth(const std::stop_token&, Finding& finding) const {
        set_depth_of_mesh_and_solid(mesh, solid, max_error(rounding), finding);
    }
    bool is_separated_by(const Point3d& motion, const std::stop_token& stop) const {
        const Pose there = moved(solid.box.pose, motion);
        const MeshAndSolid pair{mesh, {solid.solid, {solid.box.tree, there}}, rounding};
        const Meeting at = pair.meeting();
        if (at != CollisionClass::collision) return !at;
        Finding finding;
        pair.find_contacts({0, stop}, finding);
        return finding.collision_class == CollisionClass::touching;
    }
    double overlap_along(const Point3d& direction) const { return octopair::overlap_along(direction, mesh, solid); }
};

struct SolidAndPlane {
    PosedConvex solid;
    PosedPlane plane;
    double rounding;

    PlaneSpan span() const { return span_across(plane, solid); }
    Meeting meeting() const { return collision_if(meets(span())); }
    std::optional<Distance> gap(double) const {
        auto found = from(std::optional(plane_gap(plane, span())));
        std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        set_plane_contact(plane, span(), request.max_contacts, finding);
        set_class(rounding, finding);
    }
    static void set_contained_depth(const std::stop_token&, Finding&) {}
    // The depth is the least, so these are not needed.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }

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
    double rounding;

    Meeting meeting() const { return collision_if(surface_meets(mesh, plane)); }
    std::optional<Distance> gap(double) const {
        auto found = from(plane_gap(plane, mesh));
        if (found) std::swap(found->nearest[0], found->nearest[1]);
        return found;
    }
    void find_contacts(const ContactRequest& request, Finding& finding) const {
        SolidAndPlane::set_plane_contact(plane, *span_across(plane, mesh), request.max_contacts, finding);
        set_class(rounding, finding);
    }
    static void set_contained_depth(const std::stop_token&, Finding&) {}
    // The depth is the least, so these are not needed.
    static bool is_separated_by(const Point3d&, const std::stop_token&) { return false; }
    static double overlap_along(const Point3d&) { return 0; }
};

/// Returns judge(pair), where pair is one of the kinds above; `of_planes` for two planes.
/// Requires: the kind of `first` is not after the kind of `second`.
template <typename Result, typename Judge>
Result with_kind(const PosedObject& first, const PosedObject& second, Result of_planes, const Judge& judge) {
    const double rounding = rounding_of(first, second);
    const Kind a = kind_of(first), b = kind_of(second);
    if (a == Kind::mesh && b == Kind::mesh) return judge(TwoMeshes{mesh_of(first), mesh_of(second), rounding});
    if (a == Kind::mesh && b == Kind::solid)
        return judge(MeshAndSolid{mesh_of(first), boxed_solid_of(second), rounding});
    if (a == Kind::mesh) return judge(MeshAndPlane{mesh_of(first), plane_of(second), rounding});
    if (b == Kind::solid) return judge(TwoSolids{solid_of(first), solid_of(second), rounding});
    if (a == Kind::solid) return judge(SolidAndPlane{solid_of(first), plane_of(second), rounding});
    return of_planes;
}

/// Returns `reach`, enlarged so that a distance equal to `reach` up to rounding counts.
double room_for_rounding(double reach) { return reach * (1 + 1e-12); }

/// Sets depth_at_most: the least overlap along a few directions. If it equals a lower bound, the depth is the least.
template <typename Pair>
void bound_depth(const Pair& pair, const std::vector<Point3d>& directions, Finding& finding) {
    finding.depth_at_most = finding.depth;
    if (finding.depth_kind != DepthKind::at_least) return;
    double least = std::numeric_limits<double>::infinity();
    for (const Point3d& direction : directions) least = std::min(least, pair.overlap_along(direction));
    finding.depth_at_most = std::max(least, finding.depth);
    if (least <= finding.depth + pair.rounding) finding.depth_kind = DepthKind::least;
}

/// Makes penetrating objects touching if a translation within the tolerance is proven to separate them.
template <typename Pair>
void apply_tolerance(const Pair& pair, const std::vector<Point3d>& directions, const ContactRequest& request,
                     Finding& finding) {
    if (finding.collision_class != CollisionClass::penetrating || finding.depth > request.tolerance) return;
    const auto separates = [&](const Point3d& direction) {
        return pair.is_separated_by(vector::times(direction, request.tolerance), request.stop);
    };
    const bool touches =
        finding.depth_at_most <= request.tolerance || std::any_of(directions.begin(), directions.end(), separates);
    if (!touches) return;
    finding.collision_class = CollisionClass::touching;
    finding.depth_at_most = std::min(finding.depth_at_most, request.tolerance);
}

/// Finds the contacts of a pair, bounds the depth, and applies the tolerance. Some contacts are found even if none are wanted:
/// their normals are directions to try.
template <typename Pair>
void find_contacts_of(const Pair& pair, const ContactRequest& request, Finding& finding) {
    constexpr std::uint32_t enough = 16;
    pair.find_contacts({std::max(enough, request.max_contacts), request.stop}, finding);
    const std::vector<Point3d> directions = directions_out(finding.contacts);
    bound_depth(pair, directions, finding);
    if (request.tolerance > 0) apply_tolerance(pair, directions, request, finding);
    if (finding.contacts.size() <= request.max_contacts) return;
    finding.contacts.resize(request.max_contacts);
    finding.more_contacts = true;
}

/// Finds the depth of a pair of which one contains the other.
template <typename Pair>
void find_contained_depth(const Pair& pair, const std::stop_token& stop, Finding& finding) {
    pair.set_contained_depth(stop, finding);
    bound_depth(pair, directions_out({}), finding);
}

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
    constexpr double any = std::numeric_limits<double>::infinity();
    const bool in_order = kind_of(a) <= kind_of(b);
    using Answer = std::optional<ObjectGap>;
    Answer gap = with_kind(in_order ? a : b, in_order ? b : a, Answer(), [&](const auto& pair) -> Answer {
        if (pair.meeting()) return ObjectGap();
        const std::optional<Distance> found = pair.gap(any);
        if (!found) return std::nullopt;
        return ObjectGap{found->at_least, found->nearest};
    });
    if (gap && !in_order) std::swap(gap->nearest[0], gap->nearest[1]);
    return gap;
}

void find_contacts(const PosedObject& a, const PosedObject& b, const ContactRequest& request, Finding& finding) {
    if (are_duplicates(a, b, request.duplicate_tolerance)) {
        finding.collision_class = CollisionClass::duplicate;
        return;
    }
    const bool in_order = kind_of(a) <= kind_of(b);
    if (!in_order) swap_objects(finding);
    with_kind(in_order ? a : b, in_order ? b : a, 0, [&](const auto& pair) {
        if (finding.collision_class == CollisionClass::contained) {
            find_contained_depth(pair, request.stop, finding);
        } else {
            find_contacts_of(pair, request, finding);
        }
        return 0;
    });
    if (!in_order) swap_objects(finding);
}

}  // namespace octopair
