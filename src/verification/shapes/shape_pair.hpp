// judge_pair(): checks the decision of the narrow phase about one pair of objects by certificates.
//
// Certificates
//   two points, one of each object        upper bound on the distance
//   two parallel planes between objects   lower bound on the distance
//   a direction                           upper bound on the depth: the overlap along the direction
//   a polytope in the difference          lower bound on the depth: the distance from the origin to its nearest face
//   a direction                           lower bound on how far an object sticks out of another one
//   a segment that crosses a triangle     two surfaces pass through each other
//
// A certificate can prove a decision wrong. docs/design.md ("Certificates") lists which decisions have none.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "octopair/collision.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

/// The rules by which the exact filters have decided.
struct StageRules {
    double margin = 0;                     ///< as in ExactOptions
    double tolerance = 0;                  ///< as in ExactOptions
    bool features = false;                 ///< true: the feature filter has run
    std::optional<double> min_depth = {};  ///< pairs that are less deep were dropped
};

/// An object, borrowed.
struct JudgedObject {
    const Geometry& geometry;
    const Pose& pose;
    double padding = 0;
};

struct JudgedPair {
    JudgedObject a, b;
};

struct PairVerdict {
    /// What is wrong, for users; empty: no certificate contradicts the decision.
    std::string fault;
    /// What was not checked; null: all was.
    const char* not_checked = nullptr;
};

/// Judges the decision that `finding` describes; null: the filters have dropped the pair. Requires: the objects do not move.
/// Throws: Error{cancelled}. Thread safety: any thread may call it.
PairVerdict judge_pair(const JudgedPair& pair, const StageRules& rules, const Finding* finding,
                       const std::stop_token& stop = {});

}  // namespace octopair
