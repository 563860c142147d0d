// Collisions: class, distance, depth, time of impact and contacts of a pair of objects, as the exact tests compute them.
//
// Units     Lengths are in the caller's unit. Times run from 0 to 1, from an object's pose to its end pose (shapes.hpp).
// Ownership All types are plain values.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octopair/pose.hpp"

namespace octopair {

/// Relation of two objects. `collision` means that they meet and that no exact feature filter has run.
enum class CollisionClass : std::uint8_t {
    unknown,    ///< no exact filter has seen the pair
    clearance,  ///< they do not meet, but are no further apart than margin and paddings allow
    collision,
    touching,     ///< they meet, and their insides do not
    penetrating,  ///< their insides, or surfaces, pass through each other
    contained,    ///< all of one lies inside the other, and their surfaces do not meet
};

/// Where two features meet. `normal`: of length 1, from a to b: moving b along it by `depth` ends this contact.
struct Contact {
    static constexpr std::uint32_t no_feature = 0xFFFFFFFF;

    Point3d point = {};  ///< of convex shapes, in both
    Point3d normal = {};
    double depth = 0;                      ///< >= 0
    std::uint32_t feature_a = no_feature;  ///< the triangle of a mesh
    std::uint32_t feature_b = no_feature;
};

/// Result of the exact filters for one pair.
struct Finding {
    CollisionClass collision_class = CollisionClass::unknown;
    double distance = 0;                  ///< between two that do not meet
    std::array<Point3d, 2> nearest = {};  ///< of these: a point of a and one of b, that far apart
    double depth = 0;                     ///< of two that meet: how deep, where a filter found out
    double time = 0;                      ///< of moving objects: when they first meet, 0 to 1
    std::vector<Contact> contacts = {};
    bool more_contacts = false;  ///< contacts were left out for the limit's sake
    std::uint64_t note = 0;      ///< a user's own filters may use it; no other does
};

}  // namespace octopair
