// Pair tests of two objects of any shapes: whether they meet, their distance, and their contacts.
// Start here to change how two shapes are tested.
//
// A closed mesh or a convex solid includes its interior: an object inside it meets it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "narrow_phase/mesh/mesh_contacts.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct PosedObject {
    const detail::PreparedShape& geometry;
    const Pose& pose;
};

/// Returns true if two objects meet or their distance is at most `reach`. Then sets the class of `finding` to collision,
/// contained or clearance; for clearance also sets distance and nearest points.
bool judge_objects(const PosedObject& a, const PosedObject& b, double reach, Finding& finding);

struct ObjectGap {
    double at_least =
        0;  ///< distance, or a proven lower bound if the distance is only approximate; 0 if the objects meet
    std::array<Point3d, 2> nearest = {};  ///< nearest points, if the objects do not meet
};
/// Returns nothing if one of the objects is empty, or if both are planes.
std::optional<ObjectGap> object_gap(const PosedObject& a, const PosedObject& b);

/// Sets class, depth and contacts in `finding`; for contained objects only the depth.
/// Requires: the objects meet, and judge_objects() has set the class.
void find_contacts(const PosedObject& a, const PosedObject& b, const ContactRequest& request, Finding& finding);

}  // namespace octopair
