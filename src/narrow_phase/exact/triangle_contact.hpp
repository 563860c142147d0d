// Where, how and how deep two triangles meet. How they meet is decided by exact signs; places and depths are float64.
#pragma once

#include <array>
#include <cstdint>

#include "octopair/pose.hpp"

namespace octopair {

enum class TriangleMeeting : std::uint8_t {
    none,
    touching,     ///< they meet, and no more than this
    overlapping,  ///< they lie in one plane and have an area in common
    crossing      ///< they lie in different planes, and their insides pass through each other
};

struct TriangleContact {
    TriangleMeeting meeting = TriangleMeeting::none;
    unsigned count = 0;                  ///< of points: 1; 2: a segment; more: a polygon, in order
    std::array<Point3d, 6> points = {};  ///< the corners of what they have in common
};

TriangleContact triangle_contact(const Triangle3d& a, const Triangle3d& b);

/// The shortest way out of each other: b moved along `normal`, of length 1, by `depth` does no more than touch a. For
/// triangles that meet.
struct TriangleDepth {
    Point3d normal = {0, 0, 1};  ///< any, for two points
    double depth = 0;
};
TriangleDepth triangle_depth(const Triangle3d& a, const Triangle3d& b);

}  // namespace octopair
