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
    const double w = turn[0] / length, x = turn[1] / length, y = turn[2] / length, z = turn[3] / length;
    return {{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), place[0]},
              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), place[1]},
              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), place[2]}}}};
}

}  // namespace octopair
