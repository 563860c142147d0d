// Verdicts on two convex bodies: bounds on their distance and depth, and points of both.
#include "verification/shapes/verdicts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace octopair::certificate {

namespace {

bool is_finite(const Point3d& point) {
    return std::ranges::all_of(point, [](double coordinate) { return std::isfinite(coordinate); });
}

std::string judge_depth(const ConvexBody& a, const ConvexBody& b, const Decision& decision) {
    const Finding& finding = *decision.finding;
    const Real accuracy = decision.accuracy.length, tolerance = decision.rules.tolerance;
    if (!decision.rules.features || finding.depth_kind != DepthKind::least) return {};
    const DepthBounds depth = bound_depth(a, b, accuracy / 4, std::numeric_limits<Real>::infinity());
    if (finding.depth > depth.upper + accuracy)
        return "its depth is " + text_of(finding.depth) + ", but a translation of " + text_of(depth.upper) +
               " separates the objects";
    if (finding.depth < depth.lower - accuracy)
        return "its depth is " + text_of(finding.depth) + ", but it is at least " + text_of(depth.lower);
    if (finding.collision_class == CollisionClass::penetrating && depth.upper < tolerance - accuracy)
        return "it is penetrating, but a translation of " + text_of(depth.upper) + " separates the objects";
    if (finding.collision_class == CollisionClass::touching && depth.lower > tolerance + accuracy)
        return "it is touching, but its depth is at least " + text_of(depth.lower);
    return {};
}

std::string judge_contacts(const ConvexBody& a, const ConvexBody& b, const Decision& decision) {
    for (const Contact& contact : decision.finding->contacts) {
        const Real limit = decision.accuracy.contact;
        const Real outside = std::max(least_distance(contact.point, a, limit), least_distance(contact.point, b, limit));
        if (outside > limit) return "a contact point is at least " + text_of(outside) + " outside an object";
        const Vector normal = vector_of(contact.normal);
        if (std::abs(length(normal) - 1) > 1e-9L) return "the normal of a contact does not have the length 1";
        const Real overlap = -gap_along(a, b, normal) - contact.depth;
        if (overlap > decision.accuracy.length)
            return "a translation by the depth of a contact leaves an overlap of " + text_of(overlap);
    }
    return {};
}

std::string judge_contained(const ConvexBody& a, const ConvexBody& b, const std::vector<Vector>& directions,
                            const Decision& decision) {
    const Real outside = std::min(sticks_out(a, b, directions), sticks_out(b, a, directions));
    if (outside <= decision.accuracy.position) return {};
    return "it is contained, but each object sticks out of the other one by at least " + text_of(outside);
}

std::string judge_nearest(const ConvexBody& a, const ConvexBody& b, const Decision& decision) {
    const auto& [first, second] = decision.finding->nearest;
    const Real limit = decision.accuracy.length;
    const Real outside = std::max(least_distance(first, a, limit), least_distance(second, b, limit));
    if (outside > limit) return "a nearest point is at least " + text_of(outside) + " outside its object";
    return judge_nearest_points(decision);
}

}  // namespace

bool is_finite(const Finding& finding) {
    const bool contacts = std::ranges::all_of(finding.contacts, [](const Contact& contact) {
        return is_finite(contact.point) && is_finite(contact.normal) && std::isfinite(contact.depth);
    });
    return contacts && std::isfinite(finding.distance) && std::isfinite(finding.depth) &&
           is_finite(finding.nearest[0]) && is_finite(finding.nearest[1]);
}

Real least_distance(const Point3d& point, const ConvexBody& body, Real limit) {
    return bound_distance(ConvexBody({vector_of(point)}), body, limit / 16, limit).lower;
}

std::string judge_nearest_points(const Decision& decision) {
    const auto& [first, second] = decision.finding->nearest;
    const Real apart = length(vector_of(second) - vector_of(first));
    if (std::abs(apart - decision.finding->distance) <= decision.accuracy.length) return {};
    return "its nearest points are " + text_of(apart) + " apart, but its distance is " +
           text_of(decision.finding->distance);
}

std::string text_of(Real number) {
    std::array<char, 40> text{};
    (void)std::snprintf(text.data(), text.size(), "%.9Lg", number);
    return text.data();
}

bool Decision::contradicts(Real least) const {
    if (says_meet()) return false;
    return least > accuracy.length + (was_dropped() ? Real(rules.min_depth.value_or(0)) : Real(0));
}

std::vector<Vector> compared_directions(const Pose& a, const Pose& b) {
    std::vector<Vector> directions;
    constexpr int spread = 128;
    for (int i = 0; i < spread; ++i) {  // a spiral of Fibonacci
        const Real z = 1 - (2 * Real(i) + 1) / spread;
        const Real around = Real(i) * std::numbers::pi_v<Real> * (3 - std::sqrt(5.0L)), radius = std::sqrt(1 - z * z);
        directions.push_back({radius * std::cos(around), radius * std::sin(around), z});
    }
    for (const Pose* const pose : {&a, &b}) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector axis{pose->rows[0][i], pose->rows[1][i], pose->rows[2][i]};
            const Real size = length(axis);
            if (!(size > 0)) continue;
            directions.push_back(axis * (1 / size));
            directions.push_back(axis * (-1 / size));
        }
    }
    return directions;
}

Real sticks_out(const ConvexBody& inner, const ConvexBody& outer, const std::vector<Vector>& directions) {
    Real most = -std::numeric_limits<Real>::infinity();
    for (const Vector& direction : directions) most = std::max(most, inner.reach(direction) - outer.reach(direction));
    return most;
}

std::string judge_distance(const Decision& decision, Real lower, Real upper) {
    const Real position = decision.accuracy.position, accuracy = decision.accuracy.length;
    if (decision.was_dropped()) {
        const bool may_be_shallow = decision.rules.min_depth && lower <= position;
        if (upper > decision.reach - position || may_be_shallow) return {};
        return "it was dropped, but two points of the objects are " + text_of(upper) + " apart";
    }
    if (decision.says_meet()) {
        if (lower <= position) return {};
        return "the objects do not meet: they are at least " + text_of(lower) + " apart";
    }
    const Real distance = decision.finding->distance;
    if (distance > upper + accuracy)
        return "its distance is " + text_of(distance) + ", but two points are " + text_of(upper) + " apart";
    if (distance < lower - accuracy)
        return "its distance is " + text_of(distance) + ", but the objects are at least " + text_of(lower) + " apart";
    if (lower > decision.reach + decision.accuracy.margin)
        return "the objects are at least " + text_of(lower) + " apart, more than margin and paddings";
    return {};
}

PairVerdict judge_convex(const ConvexBody& a, const ConvexBody& b, const std::vector<Vector>& directions,
                         const Decision& decision) {
    const Real position = decision.accuracy.position, accuracy = decision.accuracy.length;
    const Real far_enough = decision.was_dropped() ? decision.reach + position : std::numeric_limits<Real>::infinity();
    const DistanceBounds bounds = bound_distance(a, b, position / 16, far_enough);
    std::string fault = judge_distance(decision, bounds.lower, bounds.upper);
    if (!fault.empty()) return {fault};
    if (!decision.says_meet()) {
        if (bounds.upper <= position) {
            const Real deep_enough = accuracy + Real(decision.rules.min_depth.value_or(0));
            const Real least = bound_depth(a, b, accuracy / 4, deep_enough).lower;
            if (decision.contradicts(least)) fault = "the objects overlap by at least " + text_of(least);
        }
        if (fault.empty() && !decision.was_dropped()) fault = judge_nearest(a, b, decision);
        return {fault};
    }
    if (decision.found() == CollisionClass::contained) fault = judge_contained(a, b, directions, decision);
    if (fault.empty()) fault = judge_contacts(a, b, decision);
    if (fault.empty()) fault = judge_depth(a, b, decision);
    const bool is_duplicate = decision.found() == CollisionClass::duplicate;
    return {fault, is_duplicate ? "whether duplicates are equal" : nullptr};
}

}  // namespace octopair::certificate
