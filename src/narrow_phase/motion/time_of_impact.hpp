// first_time_within(): time of impact of two moving objects, by conservative advancement (Mirtich 1996).
//
// Steps     Both objects advance by a time in which they cannot meet. This is their distance
//           divided by an upper bound on their relative speed. Or it is the gap between two separating planes divided by the
//           speed at which the planes approach: objects that pass each other take few steps.
// Safety    The result is never too late. Objects that are reported not to meet do not meet at any time.
// Tolerance Objects that come closer than 1e-6 of the smaller object's size count as meeting. Rotating objects, and meshes
//           that no plane separates, may pass at so small a gap that steps never end. So the tolerance grows fourfold after
//           every 16,384 steps.
#pragma once

#include <optional>

#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/object_pair.hpp"

namespace octopair {

struct MovingObject {
    const detail::PreparedShape& geometry;
    Motion motion;
};

/// Returns the first time, 0 to 1, at which the distance of the objects is at most `reach`; nothing if there is no such time.
/// `stop` is checked between steps; after a stop request the function returns nothing.
std::optional<double> first_time_within(const MovingObject& a, const MovingObject& b, double reach,
                                        const std::stop_token& stop);

}  // namespace octopair
