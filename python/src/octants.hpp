// Octants as a Python tuple.
#pragma once

#include <pybind11/pybind11.h>

#include "octopair/octants.hpp"

namespace octopair::python {

/// Returns (codes, bounds, leaf, entries, homes, objects, offsets, home_octants, space), which are the attributes of octopair.Octants.
pybind11::tuple octants_tuple(const Octants& octants);

}  // namespace octopair::python
