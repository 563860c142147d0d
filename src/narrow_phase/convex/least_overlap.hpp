// LeastOverlap: the least overlap of two cores along the directions that were tried.
//
// Overlap   Along a direction n: how far a reaches beyond the begin of b, so moving b by it along n separates the two. It is
//           the height of the difference a - b, the set of all differences of their points, along n.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {

class LeastOverlap {
public:
    /// Borrows `pair`.
    explicit LeastOverlap(const LocalConvexPair& pair) : pair_(pair) {}

    /// Tries a direction and its opposite. The direction has any length; does nothing if its length is 0.
    void propose(const Point3d& direction) {
        const double length = vector::length(direction);
        if (!(length > 0) || !std::isfinite(length)) return;
        const Point3d normal = {direction[0] / length, direction[1] / length, direction[2] / length};
        (void)consider(normal);
        (void)consider(vector::times(normal, -1));
    }

    /// Tries a direction of length 1. Returns the point of the difference a - b that is farthest along it.
    Point3d consider(const Point3d& normal) {
        const Point3d on_a = pair_.a().support(normal), on_b = pair_.b().support(vector::times(normal, -1));
        const Point3d vertex = vector::minus(on_a, on_b);
        const double overlap = vector::dot(vertex, normal);
        if (overlap < overlap_) overlap_ = overlap, normal_ = normal;
        return vertex;
    }

    /// Improves the best direction by small turns: along the valley of small overlaps around it, then across the valley. Repeats this with
    /// smaller turns.
    void descend() {
        double reach = 1.2, difference = 1e-3;
        for (int round = 0; round < 10; ++round) {
            const double before = overlap_;
            const auto [along, across] = valley(difference);
            turn_along(along, reach);
            turn_along(across, reach / 8);
            if (overlap_ < before) continue;
            reach /= 4;
            difference /= 4;
        }
    }

    const Point3d& normal() const { return normal_; }
    /// Overlap of the cores along normal(); below 0 if they are apart along it.
    double overlap() const { return overlap_; }

private:
    double overlap_toward(const Point3d& from, const Point3d& step) {
        const Point3d turned = vector::plus(from, step);
        const Point3d normal = vector::times(turned, 1 / vector::length(turned));
        return vector::dot(consider(normal), normal);
    }

    /// Returns the tangent at normal() along which the overlap rises least on both sides, and the tangent perpendicular to it. The
    /// overlap may have a fold along the first tangent.
    std::array<Point3d, 2> valley(double difference) {
        const Point3d from = normal_, some = vector::some_normal(from);
        const Point3d u = vector::times(some, difference / vector::length(some)), v = vector::cross(from, u);
        const auto at = [&](double angle) {
            return vector::plus(vector::times(u, std::cos(angle)), vector::times(v, std::sin(angle)));
        };
        const auto rise = [&](double angle) {
            const Point3d step = at(angle);
            return overlap_toward(from, step) + overlap_toward(from, vector::times(step, -1));
        };
        constexpr double pi = 3.141592653589793;
        const double angle = least_of(rise, {0, pi, 24});
        return {vector::times(at(angle), 1 / difference), vector::times(at(angle + pi / 2), 1 / difference)};
    }

    /// Tries directions that normal() becomes when it is turned toward `way` or away from it, by at most `reach`.
    void turn_along(const Point3d& way, double reach) {
        const Point3d from = normal_;
        (void)least_of([&](double turn) { return overlap_toward(from, vector::times(way, turn)); },
                       {-reach, reach, 16});
    }

    struct Interval {
        double low, high;
        int samples;
    };
    /// Returns approximately the place where a function is least. Evaluates samples, then runs a golden-section search around the
    /// least sample.
    template <typename Function>
    static double least_of(const Function& function, const Interval& interval) {
        const double step = (interval.high - interval.low) / interval.samples;
        double best = interval.low, least = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= interval.samples; ++i) {
            const double place = interval.low + step * i, value = function(place);
            if (value < least) least = value, best = place;
        }
        constexpr double golden = 0.6180339887498949;
        double low = best - step, high = best + step;
        double left = high - golden * (high - low), right = low + golden * (high - low);
        double at_left = function(left), at_right = function(right);
        for (int i = 0; i < 28; ++i) {
            if (at_left < at_right) {
                high = right, right = left, at_right = at_left;
                left = high - golden * (high - low);
                at_left = function(left);
            } else {
                low = left, left = right, at_left = at_right;
                right = low + golden * (high - low);
                at_right = function(right);
            }
        }
        return (low + high) / 2;
    }

    const LocalConvexPair& pair_;
    double overlap_ = std::numeric_limits<double>::infinity();
    Point3d normal_ = {1, 0, 0};
};

/// Tries directions with `least` until the least overlap is known to `slack` or to a relative 1e-10. `slack`: rounding error of a point of
/// the difference. Gives up earlier for pairs that have very many directions of nearly least overlap. The error of the overlap is then of
/// second order in the angle to the best direction.
/// Returns a proven lower bound on the least overlap; minus infinity for a difference without volume.
double find_least_overlap(LeastOverlap& least, double slack);

}  // namespace octopair
