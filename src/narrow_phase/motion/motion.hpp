// Motion: the motion of an object from one pose to another.
//
// Place     The object's origin moves on a straight line at constant speed.
// Rotation  The object rotates about its own origin, by the smaller angle, at constant angular speed.
// Rest      Any other difference of the poses, such as rounding, is interpolated linearly.
#pragma once

#include <optional>

#include "octopair/pose.hpp"

namespace octopair {

class Motion {
public:
    /// Returns nothing if no rotation leads from `begin` to `end`: one pose scales differently or mirrors, or the poses flatten
    /// and rotate.
    static std::optional<Motion> between(const Pose& begin, const Pose& end);

    /// Returns the pose at `time`, 0 to 1; at 0 and 1 exactly the two given poses.
    Pose at(double time) const;

    double angle() const { return angle_; }  ///< angle of rotation, 0 to pi
    /// Upper bound on the speed of points within `reach` of the object's origin, in its own coordinates.
    double speed(double reach) const;
    /// Upper bound on the distance of a moving point from the straight line between its places at two times, `step` apart. The point is
    /// within `reach` of the object's origin.
    double sagitta(double reach, double step) const;

private:
    Pose begin_, end_;
    Pose ready_to_end_;  ///< end_ with the rotation undone
    Point3d axis_ = {0, 0, 1};
    double angle_ = 0;
    double stretch_ = 0;  ///< upper bound on the factor by which begin_ and ready_to_end_ lengthen a vector
    double change_ = 0;   ///< norm of the difference of the linear parts of begin_ and ready_to_end_
};

}  // namespace octopair
