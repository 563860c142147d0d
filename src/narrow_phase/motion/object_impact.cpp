#include "narrow_phase/motion/object_impact.hpp"

#include <algorithm>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/motion/conservative_advancement.hpp"

namespace octopair {

namespace {

Point3d way_of(const Motion& motion) { return vector::minus(vector::place(motion.at(1)), vector::place(motion.at(0))); }

/// What turning adds to the speed of an object's points. Planes do not turn (shapes.hpp).
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
    // Places far out are not known better than float64 has them.
    return std::max(1e-6 * std::min(size(a), size(b)), 1e-14 * std::max(farthest(a), farthest(b)));
}

}  // namespace

std::optional<double> first_time_within(const MovingObject& a, const MovingObject& b, double reach,
                                        const std::stop_token& stop) {
    constexpr unsigned patience = 1 << 14;
    Passing passing{vector::minus(way_of(a.motion), way_of(b.motion)), speed_of_turning(a) + speed_of_turning(b), reach,
                    0};
    double tolerance = tolerance_of(a, b), time = 0;
    for (unsigned step = 1; !stop.stop_requested(); ++step) {
        const Pose pose_a = a.motion.at(time), pose_b = b.motion.at(time);
        const PosedObject at_a = {a.geometry, pose_a}, at_b = {b.geometry, pose_b};
        const std::optional<ObjectGap> gap = object_gap(at_a, at_b);
        if (!gap) return std::nullopt;
        // Exactly met at the beginning is no matter of tolerance.
        if (gap->at_least - reach <= (time == 0 ? 0 : tolerance)) return time;
        passing.keep = tolerance / 2;
        const double left_time = 1 - time, go_on = safe_time({at_a, at_b, *gap}, passing, left_time);
        if (go_on >= left_time) return std::nullopt;
        time += go_on;
        if (step % patience == 0) tolerance *= 4;
    }
    return std::nullopt;
}

}  // namespace octopair
