#include "narrow_phase/motion/object_impact.hpp"

#include <algorithm>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/motion/conservative_advancement.hpp"

namespace octopair {

namespace {

Point3d way_of(const Motion& motion) { return vector::minus(vector::place(motion.at(1)), vector::place(motion.at(0))); }

/// Returns the speed that rotation adds to the object's points. Planes do not rotate (shapes.hpp).
double speed_of_turning(const MovingObject& object) {
    const ShapeBounds& bounds = object.geometry.bounds;
    if (!bounds.bounded) return 0;
    return object.motion.speed(vector::length(bounds.centre) + bounds.radius) - object.motion.speed(0);
}

double tolerance_of(const MovingObject& a, const MovingObject& b) {
    const auto size = [](const MovingObject& object) {
        return object.geometry.bounds.bounded ? object.geometry.bounds.radius : std::numeric_limits<double>::infinity();
    };
    const auto farthest = [](const MovingObject& object) {
        return std::max(vector::length(vector::place(object.motion.at(0))),
                        vector::length(vector::place(object.motion.at(1))));
    };
    // Far from the origin, float64 limits the accuracy of places.
    return std::max(1e-6 * std::min(size(a), size(b)), 1e-14 * std::max(farthest(a), farthest(b)));
}

}  // namespace

std::optional<double> first_time_within(const MovingObject& a, const MovingObject& b, double reach,
                                        const std::stop_token& stop) {
    constexpr unsigned steps_per_tolerance = 1 << 14;
    RelativeMotion motion{vector::minus(way_of(a.motion), way_of(b.motion)), speed_of_turning(a) + speed_of_turning(b),
                          reach, 0};
    double tolerance = tolerance_of(a, b), time = 0;
    for (unsigned step = 1; !stop.stop_requested(); ++step) {
        const Pose pose_a = a.motion.at(time), pose_b = b.motion.at(time);
        const PosedObject at_a = {a.geometry, pose_a}, at_b = {b.geometry, pose_b};
        const std::optional<ObjectGap> gap = object_gap(at_a, at_b);
        if (!gap) return std::nullopt;
        // At time 0 the exact test decides, without tolerance.
        if (gap->at_least - reach <= (time == 0 ? 0 : tolerance)) return time;
        motion.remaining_gap = tolerance / 2;
        const double left_time = 1 - time, go_on = safe_time({at_a, at_b, *gap}, motion, left_time);
        if (go_on >= left_time) return std::nullopt;
        time += go_on;
        if (step % steps_per_tolerance == 0) tolerance *= 4;
    }
    return std::nullopt;
}

}  // namespace octopair
