// Kinds of scenes for tests: those of samples, and degenerate ones of the tests' own.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::test {

/// All kinds of samples, then "lattice", "duplicates", "segments" and so on (kinds.cpp).
std::vector<std::string> all_kind_names();

/// Valid boxes; the same for the same arguments.
std::vector<Box3f> make_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed);

/// Float64 boxes of the same kind; they use the whole precision or range where the kind is about that.
std::vector<Box3d> make_double_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed);

std::vector<Box3d> widened(const std::vector<Box3f>& boxes);
/// The box with the nearest coordinates that float32 holds.
Box3f narrowed(const Box3d& box);
Box3d rounded_to_float32(const Box3d& box);

/// Names a parametrised test by its kind.
std::string param_name(const ::testing::TestParamInfo<std::string>& info);

}  // namespace octopair::test
