// Two objects of any shapes: whether they meet, how far apart they are, how they meet.
//
// What has an inside contains what lies there: a mesh inside a closed mesh meets it, and so does a ball inside one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "narrow_phase/mesh/contact_request.hpp"
#include "narrow_phase/prepared.hpp"
#include "octopair/collision.hpp"

namespace octopair {

struct PosedObject {
    const detail::PreparedShape& geometry;
    const Pose& pose;
};

/// Whether two objects meet or are no further apart than `reach`. Then sets the class (collision, contained, clearance)
/// and, of clearance, distance and nearest points.
bool judge_objects(const PosedObject& a, const PosedObject& b, double reach, Finding& finding);

struct ObjectGap {
    double at_least = 0;  ///< the distance, or where it is known no better, what is proven of it; 0 if they meet
    std::array<Point3d, 2> nearest = {};  ///< of objects that are apart
};
/// Nothing where one of them is empty.
std::optional<ObjectGap> object_gap(const PosedObject& a, const PosedObject& b);

/// Of two objects that meet, and whose class is known so far as judge_objects() finds it: sets class, depth and contacts.
void find_contacts(const PosedObject& a, const PosedObject& b, const ContactRequest& request, Finding& finding);

}  // namespace octopair
