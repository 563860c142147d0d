#include "verification/shapes/shape_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "verification/shapes/verdicts.hpp"

namespace octopair {

namespace {

using namespace certificate;

bool is_mesh(const JudgedObject& object) { return std::holds_alternative<shape::Mesh>(object.geometry.shape()); }
const shape::Plane* plane_of(const JudgedObject& object) { return std::get_if<shape::Plane>(&object.geometry.shape()); }

/// Returns how much the products of the columns of a pose differ from those of a rotation. Returns 0 for hulls and meshes, which a pose
/// may distort.
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

Vector translation_of(const JudgedObject& object) {
    return {object.pose.rows[0][3], object.pose.rows[1][3], object.pose.rows[2][3]};
}

/// The sizes that determine the accuracy of the narrow phase.
struct Sizes {
    Real first, second;  ///< radii of the objects
    Real coordinate;     ///< largest absolute value of a coordinate
};

/// Returns the errors that the narrow phase may make (docs/proofs.md, "Certificates").
Decision::Accuracy accuracy_of(const JudgedPair& pair, const Sizes& sizes) {
    const Real small = std::min(sizes.first, sizes.second), large = std::max(sizes.first, sizes.second);
    const Real apart = length(translation_of(pair.a) - translation_of(pair.b));
    const Real position = 1e-8L * small + 1e-12L * large + 5e-14L * (sizes.coordinate + apart) +
                          (distortion(pair.a) + distortion(pair.b)) * (large + apart);
    constexpr Real very_different = 1000;
    const Real length = (large > very_different * small ? 2e-5L * large : 2e-6L * small) + position;
    return {position, position + 1e-7L * large, length, length + 1e-6L * large};
}

bool is_empty(const JudgedObject& object) {
    return is_mesh(object) && std::get<shape::Mesh>(object.geometry.shape()).triangles.empty();
}

}  // namespace

PairVerdict judge_pair(const JudgedPair& pair, const StageRules& rules, const Finding* finding,
                       const std::stop_token& stop) {
    const auto& [a, b] = pair;
    Decision decision{rules, finding, Real(rules.margin) + (Real(a.padding) + Real(b.padding)), {}};
    const bool is_plane = plane_of(a) != nullptr, other_is_plane = plane_of(b) != nullptr;
    if ((is_plane && other_is_plane) || is_empty(a) || is_empty(b))
        return {finding == nullptr ? "" : "two planes, and meshes without triangles, do not collide"};
    if (finding != nullptr && !is_finite(*finding)) return {"a number of it is not finite"};
    if (is_plane || other_is_plane) {
        const JudgedObject& other = is_plane ? b : a;
        const PlanePair with_plane{plane_in_world(is_plane ? a : b), is_plane, other, body_of(other)};
        const ConvexBody& body = with_plane.body;
        decision.accuracy = accuracy_of(
            pair, {body.radius(), body.radius(), body.largest_coordinate() + std::abs(with_plane.plane.offset)});
        return judge_plane(with_plane, decision);
    }
    const ConvexBody first = body_of(a), second = body_of(b);
    const Real coordinate = std::max(first.largest_coordinate(), second.largest_coordinate());
    decision.accuracy = accuracy_of(pair, {first.radius(), second.radius(), coordinate});
    if (is_mesh(a) || is_mesh(b)) return judge_meshes(pair, decision, stop);
    return judge_convex(first, second, compared_directions(a.pose, b.pose), decision);
}

}  // namespace octopair
