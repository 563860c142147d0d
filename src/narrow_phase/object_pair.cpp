#include "narrow_phase/object_pair.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/pair_kinds.hpp"

namespace octopair {

namespace {

bool are_near(const Point3d& a, const Point3d& b, double tolerance) {
    return a == b || vector::length(vector::minus(a, b)) <= tolerance;
}

/// Points in the shape's own coordinates, and the pose that places them.
struct PosedPoints {
    const std::vector<Point3d>& points;
    const Pose& pose;
};

bool are_near(const PosedPoints& a, const PosedPoints& b, double tolerance) {
    if (a.points.size() != b.points.size()) return false;
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        if (!are_near(vector::posed(a.pose, a.points[i]), vector::posed(b.pose, b.points[i]), tolerance)) return false;
    }
    return true;
}

std::vector<Point3d> corners_of(const Box3d& box) {
    std::vector<Point3d> corners;
    for (unsigned i = 0; i < 8; ++i) {
        Point3d corner;
        for (unsigned axis = 0; axis < 3; ++axis) corner[axis] = (i >> axis & 1u) != 0 ? box.max[axis] : box.min[axis];
        corners.push_back(corner);
    }
    return corners;
}

bool same_parameters(const ConvexSolid& a, const ConvexSolid& b) {
    return a.core == b.core && a.extents == b.extents && a.radius == b.radius && a.points.size() == b.points.size();
}

/// Returns true if the objects have the same kind of shape, equal sizes and (meshes) equal triangles. No corner may be farther than
/// `tolerance` from the same corner of the other object. Corners of shapes without vertices are those of their bounding box. So a cube
/// and its copy that is turned by 90 degrees are not duplicates.
bool are_duplicates(const PosedObject& a, const PosedObject& b, double tolerance) {
    const shape::Any &first = a.geometry.shape, &second = b.geometry.shape;
    if (first.index() != second.index() || std::holds_alternative<shape::Plane>(first)) return false;
    if (const auto* mesh = std::get_if<shape::Mesh>(&first)) {
        const auto& other = std::get<shape::Mesh>(second);
        // Compare places first: in most pairs of different objects, the first vertices already differ.
        return are_near(PosedPoints{mesh->vertices, a.pose}, {other.vertices, b.pose}, tolerance) &&
               (mesh == &other || mesh->triangles == other.triangles);
    }
    if (!same_parameters(a.geometry.convex, b.geometry.convex)) return false;
    if (std::holds_alternative<shape::ConvexHull>(first)) {
        return are_near(PosedPoints{a.geometry.convex.points, a.pose}, {b.geometry.convex.points, b.pose}, tolerance);
    }
    return are_near(PosedPoints{corners_of(a.geometry.bounds.box), a.pose}, {corners_of(b.geometry.bounds.box), b.pose},
                    tolerance);
}

/// Returns directions in which a translation of b may separate two objects: the different normals of the first 16 contacts, and both
/// directions of each world axis.
std::vector<Point3d> directions_out(std::span<const Contact> contacts) {
    constexpr std::size_t most = 16;
    std::vector<Point3d> directions;
    for (const Contact& contact : contacts.first(std::min(most, contacts.size()))) {
        const bool known = std::any_of(directions.begin(), directions.end(), [&](const Point3d& direction) {
            return vector::dot(direction, contact.normal) > 1 - 1e-9;
        });
        if (!known) directions.push_back(contact.normal);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sense : {1.0, -1.0}) {
            Point3d direction = {};
            direction[axis] = sense;
            directions.push_back(direction);
        }
    }
    return directions;
}

/// Returns `reach`, enlarged so that a distance equal to `reach` up to rounding counts.
double room_for_rounding(double reach) { return reach * (1 + 1e-12); }

/// Sets depth_at_most. If the depth is a lower bound, depth_at_most is the least overlap along `directions`. If both are equal up to
/// rounding, the depth is the least.
template <typename Pair>
void bound_depth(const Pair& pair, const std::vector<Point3d>& directions, Finding& finding) {
    finding.depth_at_most = finding.depth;
    if (finding.depth_kind != DepthKind::at_least) return;
    double least = std::numeric_limits<double>::infinity();
    for (const Point3d& direction : directions) least = std::min(least, pair.overlap_along(direction));
    finding.depth_at_most = std::max(least, finding.depth);
    if (least <= finding.depth + pair.rounding) finding.depth_kind = DepthKind::least;
}

/// Changes the class from penetrating to touching if a translation of at most the tolerance is proven to separate the objects.
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

/// Sets the thickness. Changes the class from penetrating to touching if the overlap is proven to be at most as thick as the tolerance,
/// and to go through neither object.
template <typename Pair>
void apply_thickness(const Pair& pair, const ContactRequest& request, Finding& finding) {
    if (finding.collision_class != CollisionClass::penetrating) {
        finding.thickness = finding.depth_at_most;
        finding.thickness_kind = ThicknessKind::at_most;
        return;
    }
    const OverlapThickness overlap = pair.thickness(request.tolerance, request.stop);
    finding.thickness = overlap.thickness;
    finding.thickness_kind = overlap.kind;
    if (overlap.kind == ThicknessKind::at_most) finding.collision_class = CollisionClass::touching;
}

/// Finds the contacts of a pair, bounds the depth, and applies the tolerance. Finds a few contacts even if the caller wants no contacts,
/// because bound_depth() and apply_tolerance() try their normals as directions.
template <typename Pair>
void find_contacts_of(const Pair& pair, const ContactRequest& request, Finding& finding) {
    constexpr std::uint32_t enough = 16;
    pair.find_contacts({std::max(enough, request.max_contacts), request.stop}, finding);
    const std::vector<Point3d> directions = directions_out(finding.contacts);
    bound_depth(pair, directions, finding);
    if (request.tolerance > 0) {
        apply_tolerance(pair, directions, request, finding);
        apply_thickness(pair, request, finding);
    }
    if (finding.contacts.size() <= request.max_contacts) return;
    finding.contacts.resize(request.max_contacts);
    finding.more_contacts = true;
}

/// Finds the depth of two objects of which one contains the other.
template <typename Pair>
void find_contained_depth(const Pair& pair, const std::stop_token& stop, Finding& finding) {
    pair.set_contained_depth(stop, finding);
    bound_depth(pair, directions_out({}), finding);
}

/// Converts a finding about (a, b) to a finding about (b, a).
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
    const std::optional<ObjectDistance> gap = pair.gap(most);
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
        const std::optional<ObjectDistance> found = pair.gap(any);
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
