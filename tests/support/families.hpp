// Families of random scenes with any number of objects. They have the shapes of users' long-tailed, anisotropic and
// layered scenes, which the kinds of `generate` lack.
//
// Each family draws its own parameters (sizes, exponents, folds) from the seed. Most scenes have fewer than 100 pairs
// per object, so that a second algorithm can check large scenes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/cases.hpp"

namespace octopair::test {

std::vector<std::string> family_names();

/// Makes a random call with about `objects` objects of a family; in a join, both sets together have so many. Precision
/// and place in space are random; some calls have a margin or paddings, some are joins. A pure function of its
/// arguments.
Case make_family_case(const std::string& family, std::uint64_t objects, std::uint64_t seed);

/// Returns a scene that once had 7,455 duplicate pairs. Centres are uniform in the unit cube. The side on axis k is
/// S[k] * 2^(4u) * (0.3 + v), with S = .0025, .0115, .041, and u and v uniform in [0, 1).
std::vector<Box3f> long_tailed_boxes(std::uint64_t objects, std::uint64_t seed);

}  // namespace octopair::test
