// When two moving objects first meet: conservative advancement (Mirtich 1996). From where they are, both go on for as long
// as they cannot possibly meet: their distance over the most that their speeds can add up to; or the gap between two planes
// that part them over how fast these close, so that two that pass each other take few steps.
//
// Never too late: what is said not to meet does not, at any time. Tolerance: two that come closer than a millionth of the
// smaller one's size are taken to meet. Turning things, and meshes that no plane parts, may pass each other at so small a
// part of their way that steps never end; after each 16,384 the tolerance grows fourfold.
#pragma once

#include <optional>

#include "narrow_phase/motion/motion.hpp"
#include "narrow_phase/object_pair.hpp"

namespace octopair {

struct MovingObject {
    const detail::PreparedShape& geometry;
    Motion motion;
};

/// The first time, 0 to 1, at which they are no further apart than `reach`; nothing if they never are. `stop` is looked at
/// between steps: after a request there is nothing, too.
std::optional<double> first_time_within(const MovingObject& a, const MovingObject& b, double reach,
                                        const std::stop_token& stop);

}  // namespace octopair
