// Verdicts on two convex bodies, and the rules that verdicts on all shapes share.
#pragma once

#include <string>
#include <vector>

#include "verification/shapes/distance_bounds.hpp"
#include "verification/shapes/shape_pair.hpp"

namespace octopair::certificate {

/// The decision about a pair, and what it depends on.
struct Decision {
    /// Largest errors that the narrow phase may make.
    struct Accuracy {
        Real position;  ///< of a point, and of the decision whether objects meet
        Real margin;    ///< of the distance up to which pairs are kept
        Real length;    ///< of a depth or a distance
        Real contact;   ///< of a contact point of curved shapes
    };

    const StageRules& rules;
    const Finding* finding;  ///< null: the pair was dropped
    Real reach;              ///< margin and paddings
    Accuracy accuracy;

    /// Returns the class; for a pair that was dropped, `clearance`.
    CollisionClass found() const { return finding != nullptr ? finding->collision_class : CollisionClass::clearance; }
    bool says_meet() const { return found() != CollisionClass::clearance; }
    bool was_dropped() const { return finding == nullptr; }
    /// Returns whether a depth of `least` or more contradicts that the objects do not meet, or that they were dropped.
    bool contradicts(Real least) const;
};

// Functions that return a text describe a fault; an empty text: there is none.

/// Judges what bounds on the distance of two objects allow.
std::string judge_distance(const Decision& decision, Real lower, Real upper);
/// Judges whether the nearest points are as far apart as the distance says. Requires: the class is `clearance`.
std::string judge_nearest_points(const Decision& decision);
/// Returns a lower bound on the distance of a point from a body: their distance, or a number above `limit`.
Real least_distance(const Point3d& point, const ConvexBody& body, Real limit);
/// Returns whether all numbers of a finding are finite.
bool is_finite(const Finding& finding);

/// Judges two convex objects. `directions`: those in which a contained object is compared with the other one.
PairVerdict judge_convex(const ConvexBody& a, const ConvexBody& b, const std::vector<Vector>& directions,
                         const Decision& decision);

/// Returns directions that are spread over the sphere, and the axes of two poses.
std::vector<Vector> compared_directions(const Pose& a, const Pose& b);

/// Returns how far `inner` sticks out of `outer` along one of the directions; 0 or less: along none.
Real sticks_out(const ConvexBody& inner, const ConvexBody& outer, const std::vector<Vector>& directions);

/// Returns a number for a message, such as "0.25".
std::string text_of(Real number);

}  // namespace octopair::certificate
