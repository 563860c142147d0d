// Checks how the models of several inputs fit together: their units and their places.
#pragma once

#include <string>
#include <vector>

#include "cli/input/input_set.hpp"

namespace octopair::cli {

/// Adds warnings, each one line:
/// - Some inputs state a unit, and others do not. The coordinates of the others count as if they had the same unit.
/// - The box of all of an input meets the box of no other input: they are more than `margin` apart. In a join, the others are those of the
///   other set. This is about models. Files of boxes have no origin of their own.
/// Requires: the sets are whole and have boxes.
void add_placement_warnings(const SetPair& sets, double margin, std::vector<std::string>& warnings);

}  // namespace octopair::cli
