// Kinds of scenes for tests: the kinds of samples, and degenerate kinds for tests only.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::test {

/// Returns the names of the kinds of samples.
std::vector<std::string> sample_kind_names();
/// Returns sample_kind_names(), then "lattice", "duplicates", "segments" and so on (kinds.cpp).
std::vector<std::string> all_kind_names();

/// Makes valid boxes. A pure function of its arguments.
std::vector<Box3f> make_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed);

/// Makes float64 boxes of a kind, with the full precision or range of float64 if the kind tests precision or range.
std::vector<Box3d> make_double_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed);

std::vector<Box3d> widened(const std::vector<Box3f>& boxes);
/// Returns the box with the nearest float32 coordinates.
Box3f narrowed(const Box3d& box);
Box3d rounded_to_float32(const Box3d& box);

/// Names a parametrised test after its kind.
std::string param_name(const ::testing::TestParamInfo<std::string>& info);

}  // namespace octopair::test
