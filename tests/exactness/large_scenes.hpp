// Large scenes: cases of thousands of objects, checked against the second algorithm.
#pragma once

#include <cstdint>
#include <optional>

#include "exactness/case_check.hpp"

namespace octopair::test {

/// Makes the i-th large case: `least` to 7 times as many objects of a family, with few enough pairs for the second
/// algorithm. A pure function of its arguments.
Case large_case(std::uint64_t i, std::uint64_t least);

/// Checks a large case. A finding includes the smallest case that still fails, as text for a test.
std::optional<Finding> check_large_case(const Case& a_case, const EngineFor& engines, Calls calls);

/// Makes a join of the vertices of a cloth with its faces, as in a cloth simulation.
Case cloth_case(std::uint64_t objects, std::uint64_t seed);

}  // namespace octopair::test
