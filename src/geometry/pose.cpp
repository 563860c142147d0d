// make_pose(): makes a pose from a position and a quaternion.
#include <cmath>

#include "base/floating_point_scope.hpp"
#include "octopair/error.hpp"
#include "octopair/pose.hpp"

namespace octopair {

Pose make_pose(const Point3d& place, const std::array<double, 4>& turn) {
    const FloatingPointScope scope;
    const double length = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
    if (!(length > 0) || !std::isfinite(length)) {
        throw Error(ErrorCode::bad_input, "the quaternion of a pose must be finite and not 0");
    }
    // Scaling by a power of two and a division by the square of the length, without a square root: so quarter turns and other
    // rotations with coefficients in few bits are exact.
    int exponent = 0;
    (void)std::frexp(length, &exponent);
    const auto scaled = [&](std::size_t i) { return std::ldexp(turn[i], -exponent); };
    const double w = scaled(0), x = scaled(1), y = scaled(2), z = scaled(3);
    const double square = w * w + x * x + y * y + z * z;
    const auto part = [&](double sum) { return sum / square; };
    return {{{{part(w * w + x * x - y * y - z * z), part(2 * (x * y - w * z)), part(2 * (x * z + w * y)), place[0]},
              {part(2 * (x * y + w * z)), part(w * w - x * x + y * y - z * z), part(2 * (y * z - w * x)), place[1]},
              {part(2 * (x * z - w * y)), part(2 * (y * z + w * x)), part(w * w - x * x - y * y + z * z), place[2]}}}};
}

}  // namespace octopair
