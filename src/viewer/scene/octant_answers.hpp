// Answers about the octants of a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "octopair/octants.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace octopair::viewer {

Answer octant_summary(const Octants& octants);
Answer octant_level(const Octants& octants, unsigned level, const Point3d& origin);
/// Returns the octants of an octree of the boxes that exist in the frame, on `threads` threads; 0: one per core.
Octants octants_of(const ShownFrame& frame, unsigned threads = 0);
/// Returns for each object the level of the octant in which its box begins; 0 for objects that do not exist.
std::vector<std::uint8_t> levels_of(const FrameData& data, const Octants& octants);
/// Returns the code of the octant in which an object's box begins. Requires: the object exists in the frame.
OctalCode home_code(const FrameData& data, std::uint32_t object, const Octants& octants);

}  // namespace octopair::viewer
