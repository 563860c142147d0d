// Tuning for tests of small scenes: constants so small that a few boxes take the paths of crowded scenes.
#pragma once

#include <cstdint>

#include "base/tuning.hpp"

namespace octopair::test {

/// A pure function of the seed. Some constants stay as they are, others are 1 to a few.
Tuning tiny_tuning(std::uint64_t seed);

}  // namespace octopair::test
