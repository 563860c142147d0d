// Collisions: results of the exact tests for a pair of objects: class, distance, depth, time of impact and contacts.
//
// Units     Lengths are in the caller's unit. Times run from 0 to 1, from an object's pose to its end pose (shapes.hpp).
// Ownership All types are plain values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octopair/pose.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// Relation of two objects.
enum class CollisionClass : std::uint8_t {
    unknown,    ///< no exact filter has tested the pair
    clearance,  ///< the objects do not meet; their distance is at most margin + both paddings
    collision,  ///< the objects meet; no exact feature filter has determined how
    touching,   ///< the objects meet, but their interiors do not, or overlap by at most the tolerance (docs/design.md)
    penetrating,  ///< their interiors meet, or their surfaces pass through each other
    contained,    ///< one object lies inside the other, and their surfaces do not meet
    duplicate,    ///< the objects have the same geometry, in the same place within the tolerance
    undecided,  ///< no collision: one object may be inside the other, whose mesh is not closed (ExactOptions::keep_undecided)
};

/// Number of classes, for arrays that a class indexes.
inline constexpr std::size_t collision_classes = 8;

/// Says how a depth relates to the length of the shortest translation that separates two objects.
enum class DepthKind : std::uint8_t {
    unknown,   ///< no filter computed a depth
    least,     ///< equal, to about a millionth of the smaller object's size; between polyhedra, to rounding
    at_least,  ///< a lower bound: no shorter translation separates the objects
};

/// Says how a thickness relates to the diameter of the largest ball that lies in both objects.
enum class ThicknessKind : std::uint8_t {
    unknown,   ///< no filter computed a thickness
    at_most,   ///< an upper bound, proven
    at_least,  ///< a lower bound: such a ball was found
    undecided  ///< a lower bound that is at most the tolerance; no upper bound that is at most the tolerance could be proven
};

/// The contact of two features. If b moves by `depth` along `normal`, this contact ends.
struct Contact {
    static constexpr std::uint32_t no_feature = 0xFFFFFFFF;

    Point3d point = {};                    ///< contact point; between convex shapes it lies in both (docs/formats.md)
    Point3d normal = {};                   ///< unit vector, from a to b
    double depth = 0;                      ///< penetration depth, >= 0
    std::uint32_t feature_a = no_feature;  ///< index of the triangle, if a is a mesh
    std::uint32_t feature_b = no_feature;  ///< index of the triangle, if b is a mesh
};

/// Result of the exact filters for one pair.
struct Finding {
    CollisionClass collision_class = CollisionClass::unknown;
    double distance = 0;                  ///< distance of objects that do not meet
    std::array<Point3d, 2> nearest = {};  ///< nearest points of a and b, if they do not meet; `distance` apart
    double depth = 0;                     ///< penetration depth of objects that meet, if a filter computed it
    DepthKind depth_kind = DepthKind::unknown;
    double depth_at_most = 0;       ///< length of a translation that was found to separate the objects; >= depth
    std::array<bool, 2> open = {};  ///< whether a and b are meshes with a part that is not closed (Geometry::closed)
    double time = 0;                ///< time of impact of moving objects, 0 to 1
    std::vector<Contact> contacts = {};  ///< deepest first
    bool more_contacts = false;          ///< true if contacts were left out because of a limit
    std::uint64_t note = 0;              ///< free for a user's own filters; octopair does not use it
    double thickness = 0;  ///< thickness of the overlap of closed solids, if a filter compared it with the tolerance
    ThicknessKind thickness_kind = ThicknessKind::unknown;
};

}  // namespace octopair
