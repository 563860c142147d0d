// Motion: how an object gets from one pose to another. It moves straight and turns evenly about its own origin, the
// short way; where the two poses are the same turn of it but for rounding, what differs is blended in evenly.
#pragma once

#include <optional>

#include "octopair/pose.hpp"

namespace octopair {

class Motion {
public:
    /// None, if no turn leads from one to the other: poses that scale differently, mirror, or flatten and turn.
    static std::optional<Motion> between(const Pose& begin, const Pose& end);

    /// At 0 and 1 exactly the two poses.
    Pose at(double time) const;

    double angle() const { return angle_; }  ///< 0 to pi
    /// No point of an object goes faster that lies within `reach` of the object's origin, in its own space.
    double speed(double reach) const;
    /// How far from the straight way between its places at two times, `step` apart, such a point may be.
    double sagitta(double reach, double step) const;

private:
    Pose begin_, end_;
    Pose ready_to_end_;  ///< the end, turned back
    Point3d axis_ = {0, 0, 1};
    double angle_ = 0;
    double stretch_ = 0;  ///< the poses, and what differs, make nothing longer than this times its length
    double change_ = 0;
};

}  // namespace octopair
