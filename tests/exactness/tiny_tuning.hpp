// Tuning for tests of small scenes: constants so small that a few boxes take the paths of crowded scenes.
#pragma once

#include <cstdint>

#include "base/tuning.hpp"

namespace octopair::test {

/// Makes a tuning. Some constants keep their usual values, others are 1 to a few. A pure function of `seed`.
Tuning tiny_tuning(std::uint64_t seed);

}  // namespace octopair::test
