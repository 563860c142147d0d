// safe_time(): the step of conservative advancement, a time during which two moving objects cannot come within reach.
//
// Convex    Two parallel planes separate two convex objects and move with them. The speed at which the planes approach bounds
//           the time. So objects that pass each other take long steps.
// Planes    The plane itself is the separating plane.
// Meshes    The result is the smallest time over all pairs of triangles, or of a triangle and a solid.
#pragma once

#include <algorithm>

#include "geometry/vector.hpp"
#include "narrow_phase/object_pair.hpp"

namespace octopair {

/// Motion of object a relative to object b. Times are fractions of the whole motion, 0 to 1.
struct RelativeMotion {
    Point3d displacement;  ///< displacement of a relative to b during the whole motion
    double turning_speed;  ///< sum of the speeds that rotation adds to points of a and of b
    double reach;          ///< distance at which the objects count as meeting
    double remaining_gap;  ///< gap beyond `reach` that should remain after a step
    /// Upper bound on the relative speed of two points.
    double max_speed() const { return vector::length(displacement) + turning_speed; }

    /// Returns the time in which `gap - reach` shrinks at `speed` to `remaining_gap` or to half of itself, whichever takes
    /// longer; 0 if the gap is at most `reach`.
    double time_for(double gap, double speed) const {
        const double left = gap - reach;
        return left > 0 ? std::max(left - remaining_gap, left / 2) * (1 - 1e-9) / speed : 0;
    }
    /// Returns the same time for the gap between two planes perpendicular to `direction`, which has length 1 and points from
    /// a to b.
    double time_across(double gap, const Point3d& direction) const {
        return time_for(gap, (std::max(0.0, vector::dot(displacement, direction)) + turning_speed) * (1 + 1e-9));
    }
};

/// Two objects at the current time and the gap between them. Borrowed.
struct ObjectsApart {
    const PosedObject &a, &b;
    const ObjectGap& gap;
};

/// Returns a time, at most `most`, during which the objects cannot come within `motion.reach`.
/// Requires: the gap is larger than the reach.
double safe_time(const ObjectsApart& pair, const RelativeMotion& motion, double most);

}  // namespace octopair
