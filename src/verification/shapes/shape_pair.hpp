// judge_pair(): checks the decision of the narrow phase about one pair of objects by certificates. docs/proofs.md ("Certificates") lists
// them, and the decisions that have none.
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

/// An object with its pose and padding. Borrows the shape and the pose.
struct JudgedObject {
    const Geometry& geometry;
    const Pose& pose;
    double padding = 0;
};

struct JudgedPair {
    JudgedObject a, b;
};

struct PairVerdict {
    /// Describes to users what is wrong; empty: no certificate contradicts the decision.
    std::string fault;
    /// Describes to users what no certificate judges; null: all was judged.
    const char* not_checked = nullptr;
};

/// Judges the decision that `finding` describes; null: the filters have dropped the pair. Requires: the objects do not move.
/// Throws: Error{cancelled}. Thread safety: any thread may call it.
PairVerdict judge_pair(const JudgedPair& pair, const StageRules& rules, const Finding* finding,
                       const std::stop_token& stop = {});

}  // namespace octopair
