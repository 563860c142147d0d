#include "geometry/shape/object_impact.hpp"

#include <algorithm>
#include <limits>

#include "geometry/shape/vector.hpp"

namespace octopair {

namespace {

Point3d way_of(const Motion& motion) { return vector::minus(vector::place(motion.at(1)), vector::place(motion.at(0))); }

/// What turning adds to the speed of an object's points. Planes do not turn (shapes.hpp).
double speed_of_turning(const MovingObject& object) {
    const ShapeBounds& bounds = object.geometry.bounds;
    if (!bounds.bounded) return 0;
    return object.motion.speed(vector::length(bounds.centre) + bounds.radius) - object.motion.speed(0);
}

/// Two points, one of each, come closer by at most this in the whole time.
double most_approach(const MovingObject& a, const MovingObject& b) {
    const double straight = vector::length(vector::minus(way_of(a.motion), way_of(b.motion)));
    return (straight + speed_of_turning(a) + speed_of_turning(b)) * (1 + 1e-9);
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
    constexpr unsigned patience = 256;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double approach = most_approach(a, b);
    double tolerance = tolerance_of(a, b), time = 0;
    for (unsigned step = 1; !stop.stop_requested(); ++step) {
        const Pose pose_a = a.motion.at(time), pose_b = b.motion.at(time);
        const double distance = object_distance({a.geometry, pose_a}, {b.geometry, pose_b}, infinity) - reach;
        // Exactly met at the beginning is no matter of tolerance.
        if (distance <= (time == 0 ? 0 : tolerance)) return time;
        if (!(approach > 0)) return std::nullopt;
        const double next = time + std::max(distance - tolerance / 2, distance / 2) / approach;
        if (!(next <= 1)) return std::nullopt;
        time = next;
        if (step % patience == 0) tolerance *= 4;
    }
    return std::nullopt;
}

}  // namespace octopair
