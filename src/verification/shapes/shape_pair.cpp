#include "verification/shapes/shape_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "verification/shapes/convex_verdict.hpp"
#include "verification/shapes/mesh_verdict.hpp"

namespace octopair {

namespace {

using namespace certificate;

bool is_mesh(const JudgedObject& object) { return std::holds_alternative<shape::Mesh>(object.geometry.shape()); }
const shape::Plane* plane_of(const JudgedObject& object) { return std::get_if<shape::Plane>(&object.geometry.shape()); }

/// Returns how much the columns of a pose differ from those of a rotation. 0 for shapes that a pose may distort.
Real distortion(const JudgedObject& object) {
    if (std::holds_alternative<shape::ConvexHull>(object.geometry.shape()) || is_mesh(object)) return 0;
    Real most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            Real sum = i == k ? -1 : 0;
            for (const auto& row : object.pose.rows) sum += Real(row[i]) * Real(row[k]);
            most = std::max(most, std::abs(sum));
        }
    }
    return most;
}

/// Returns the shape, or the convex hull of a mesh's triangles. Requires: not a plane; a mesh has a triangle.
ConvexBody body_of(const JudgedObject& object) {
    if (!is_mesh(object)) return {object.geometry.shape(), object.pose};
    std::vector<Vector> corners;
    for (const Triangle& triangle : triangles_of(object))
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    return ConvexBody(std::move(corners));
}

Vector place_of(const JudgedObject& object) {
    return {object.pose.rows[0][3], object.pose.rows[1][3], object.pose.rows[2][3]};
}

/// What the accuracy of the narrow phase depends on.
struct Sizes {
    Real first, second;  ///< radii of the objects
    Real coordinate;     ///< largest absolute value of a coordinate
};

/// Returns the errors that the narrow phase may make (docs/formats.md).
Decision::Accuracy accuracy_of(const JudgedPair& pair, const Sizes& sizes) {
    const Real small = std::min(sizes.first, sizes.second), large = std::max(sizes.first, sizes.second);
    const Real apart = length(place_of(pair.a) - place_of(pair.b));
    const Real place = 1e-8L * small + 1e-12L * large + 2e-14L * sizes.coordinate +
                       (distortion(pair.a) + distortion(pair.b)) * (large + apart);
    constexpr Real very_different = 1000;
    const Real length = (large > very_different * small ? 2e-5L * large : 2e-6L * small) + place;
    return {place, length, length + 1e-6L * large};
}

/// The coordinates of an object along the normal of a plane, from the plane on.
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

/// Judges a plane and another object.
PairVerdict judge_plane(const JudgedPair& pair, Decision decision) {
    const JudgedObject& plane_object = plane_of(pair.a) != nullptr ? pair.a : pair.b;
    const JudgedObject& other = plane_of(pair.a) != nullptr ? pair.b : pair.a;
    const shape::Plane& plane = *plane_of(plane_object);
    const auto& rows = plane_object.pose.rows;
    const Vector local = vector_of(plane.normal);
    const auto turned = [&](std::size_t i) { return dot({rows[i][0], rows[i][1], rows[i][2]}, local); };
    const Vector turned_normal{turned(0), turned(1), turned(2)};
    const Vector normal = turned_normal * (1 / length(turned_normal));
    const Real offset = Real(plane.offset) / length(local) + dot(normal, place_of(plane_object));

    const ConvexBody body = body_of(other);
    decision.accuracy = accuracy_of(pair, {body.radius(), body.radius(), body.largest_coordinate() + std::abs(offset)});
    const Extent whole{-body.reach(-normal) - offset, body.reach(normal) - offset};
    // A mesh may have parts on both sides.
    Real distance = is_mesh(other) ? std::numeric_limits<Real>::infinity() : whole.distance();
    for (const Triangle& triangle : triangles_of(other)) {
        Extent extent;
        for (const Vector& corner : triangle) extent.add(dot(corner, normal) - offset);
        distance = std::min(distance, extent.distance());
    }
    std::string fault = judge_distance(decision, distance, distance);
    if (!fault.empty()) return {fault};
    if (distance == 0 && decision.contradicts(whole.depth()))
        return {"the plane cuts the object to a depth of " + text_of(whole.depth())};
    if (!decision.says_meet() || !decision.rules.features) return {};
    if (is_mesh(other)) return {"", "depths and contacts of meshes"};
    const bool has_depth = decision.finding->depth_kind == DepthKind::least;
    if (has_depth && !(std::abs(whole.depth() - decision.finding->depth) <= decision.accuracy.length))
        return {"its depth is " + text_of(decision.finding->depth) + ", not " + text_of(whole.depth())};
    return {};
}

bool is_empty(const JudgedObject& object) {
    return is_mesh(object) && std::get<shape::Mesh>(object.geometry.shape()).triangles.empty();
}

}  // namespace

PairVerdict judge_pair(const JudgedPair& pair, const StageRules& rules, const Finding* finding,
                       const std::stop_token& stop) {
    const auto& [a, b] = pair;
    Decision decision{rules, finding, Real(rules.margin) + (Real(a.padding) + Real(b.padding)), {}};
    const bool any_plane = plane_of(a) != nullptr || plane_of(b) != nullptr;
    if ((plane_of(a) != nullptr && plane_of(b) != nullptr) || is_empty(a) || is_empty(b))
        return {finding == nullptr ? "" : "two planes, and meshes without triangles, do not collide"};
    if (any_plane) return judge_plane(pair, decision);
    const ConvexBody first = body_of(a), second = body_of(b);
    const Real coordinate = std::max(first.largest_coordinate(), second.largest_coordinate());
    decision.accuracy = accuracy_of(pair, {first.radius(), second.radius(), coordinate});
    if (is_mesh(a) || is_mesh(b)) return judge_meshes(pair, decision, stop);
    return judge_convex(first, second, compared_directions(a.pose, b.pose), decision);
}

}  // namespace octopair
