// Verdicts on a plane and another object, by the extent of the object along the plane's normal.
#include "verification/shapes/verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace octopair::certificate {

namespace {

/// The lowest and the highest point of an object relative to a plane.
struct Extent {
    Real lowest = std::numeric_limits<Real>::infinity(), highest = -std::numeric_limits<Real>::infinity();

    void add(Real height) {
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
    }
    Real distance() const { return std::max({Real(0), lowest, -highest}); }
    /// Length of the shortest translation that ends the contact with the plane.
    Real depth() const { return std::max(Real(0), std::min(highest, -lowest)); }
};

class PlaneVerdict {
public:
    PlaneVerdict(const PlanePair& pair, const Decision& decision)
        : pair_(pair),
          plane_(pair.plane),
          decision_(decision),
          triangles_(triangles_of(pair.other)),
          is_mesh_(std::holds_alternative<shape::Mesh>(pair.other.geometry.shape())),
          extent_{-pair.body.reach(-plane_.normal) - plane_.offset, pair.body.reach(plane_.normal) - plane_.offset} {}

    PairVerdict judge() const {
        const Real distance = this->distance();
        std::string fault = judge_distance(decision_, distance, distance);
        if (!fault.empty()) return {fault};
        if (distance == 0 && decision_.contradicts(extent_.depth()))
            return {"the plane cuts the object to a depth of " + text_of(extent_.depth())};
        if (decision_.was_dropped()) return {};
        if (!decision_.says_meet()) return {judge_nearest()};
        if (decision_.found() == CollisionClass::contained || decision_.found() == CollisionClass::duplicate)
            return {"a plane neither contains an object nor equals one"};
        if (!decision_.rules.features) return {};
        if (is_mesh_) return {"", "depths and contacts of meshes"};
        fault = judge_depth();
        return {fault.empty() ? judge_contacts() : fault};
    }

private:
    Real distance() const {
        if (!is_mesh_) return extent_.distance();
        Real least = std::numeric_limits<Real>::infinity();  // a mesh may have parts on both sides
        for (const Triangle& triangle : triangles_) {
            Extent extent;
            for (const Vector& corner : triangle) extent.add(plane_.height(corner));
            least = std::min(least, extent.distance());
        }
        return least;
    }

    /// Returns a lower bound on the distance of a point from the other object.
    Real distance_from_other(const Point3d& point, Real limit) const {
        return is_mesh_ ? least_distance(point, triangles_, limit) : least_distance(point, pair_.body, limit);
    }

    std::string judge_nearest() const {
        const auto& nearest = decision_.finding->nearest;
        const Point3d &on_plane = nearest[pair_.plane_is_first ? 0 : 1],
                      &on_other = nearest[pair_.plane_is_first ? 1 : 0];
        const Real limit = decision_.accuracy.length;
        const Real outside =
            std::max(std::abs(plane_.height(vector_of(on_plane))), distance_from_other(on_other, limit));
        if (outside > limit) return "a nearest point is at least " + text_of(outside) + " outside its object";
        return judge_nearest_points(decision_);
    }

    std::string judge_depth() const {
        const Finding& finding = *decision_.finding;
        const Real depth = extent_.depth(), accuracy = decision_.accuracy.length, tolerance = decision_.rules.tolerance;
        if (finding.depth_kind == DepthKind::least && std::abs(depth - finding.depth) > accuracy)
            return "its depth is " + text_of(finding.depth) + ", not " + text_of(depth);
        if (finding.collision_class == CollisionClass::penetrating && depth < tolerance - accuracy)
            return "it is penetrating, but its depth is " + text_of(depth);
        if (finding.collision_class == CollisionClass::touching && depth > tolerance + accuracy)
            return "it is touching, but its depth is " + text_of(depth);
        return {};
    }

    /// A contact point is the middle between the plane and the deepest point of the object.
    std::string judge_contacts() const {
        for (const Contact& contact : decision_.finding->contacts) {
            const Vector out = pair_.plane_is_first ? vector_of(contact.normal) : -vector_of(contact.normal);
            const Real side = dot(out, plane_.normal) > 0 ? 1 : -1;
            if (length(out - plane_.normal * side) > 1e-9L) return "the normal of a contact is not that of the plane";
            const Real overlap = -(side > 0 ? extent_.lowest : -extent_.highest) - contact.depth;
            if (overlap > decision_.accuracy.length)
                return "a translation by the depth of a contact leaves an overlap of " + text_of(overlap);
            const Vector deepest = vector_of(contact.point) - out * (Real(contact.depth) / 2);
            const Real limit = decision_.accuracy.contact;
            const Real outside = bound_distance(ConvexBody({deepest}), pair_.body, limit / 16, limit).lower;
            if (outside > limit) return "a contact point is at least " + text_of(outside) + " outside the object";
        }
        return {};
    }

    const PlanePair& pair_;
    const WorldPlane& plane_;
    const Decision& decision_;
    std::vector<Triangle> triangles_;
    bool is_mesh_;
    Extent extent_;
};

}  // namespace

WorldPlane plane_in_world(const JudgedObject& object) {
    const auto& plane = std::get<shape::Plane>(object.geometry.shape());
    const auto& rows = object.pose.rows;
    const Vector local = vector_of(plane.normal);
    const auto turned = [&](std::size_t i) { return dot({rows[i][0], rows[i][1], rows[i][2]}, local); };
    const Vector turned_normal{turned(0), turned(1), turned(2)};
    const Vector normal = turned_normal * (1 / length(turned_normal));
    return {normal, Real(plane.offset) / length(local) + dot(normal, {rows[0][3], rows[1][3], rows[2][3]})};
}

PairVerdict judge_plane(const PlanePair& pair, const Decision& decision) {
    return PlaneVerdict(pair, decision).judge();
}

}  // namespace octopair::certificate
