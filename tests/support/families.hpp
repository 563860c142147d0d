// Families of random scenes, richer than the kinds of `generate`: the shapes that long-tailed, anisotropic and layered
// scenes of users have, at any number of objects.
//
// Each family draws its own parameters (sizes, exponents, folds) from the seed. Most scenes have fewer than 100 pairs an
// object, so that a second algorithm can judge large ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/cases.hpp"

namespace octopair::test {

std::vector<std::string> family_names();

/// A random call about about `objects` objects of a family (two sets of a join: together): float32 or float64, anywhere
/// in space, sometimes with margin and padding, sometimes a join. A pure function of its arguments.
Case make_family_case(const std::string& family, std::uint64_t objects, std::uint64_t seed);

/// The scene that once had 7,455 pairs twice: uniform centres in the unit cube, sides S[k] * 2^(4u) * (0.3 + v) on axis k
/// with S = .0025, .0115, .041.
std::vector<Box3f> long_tailed_boxes(std::uint64_t objects, std::uint64_t seed);

}  // namespace octopair::test
