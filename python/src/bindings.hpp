// The parts of the module octopair._core. Each function adds the classes and functions of the source file of its name.
#pragma once

#include <pybind11/pybind11.h>

// Not every source needs these, but a conversion that is defined in some sources of a module must be defined in all.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "octopair/octants.hpp"

namespace octopair::python {

namespace py = pybind11;

void bind_engines(py::module_& module);
void bind_jobs(py::module_& module);
void bind_octants(py::module_& module);
void bind_scenes(py::module_& module);
void bind_shapes(py::module_& module);
void bind_spheres(py::module_& module);
void bind_pipeline(py::module_& module);

/// Returns (codes, bounds, leaf, entries, homes, objects, offsets, home_octants, space), which are the attributes of octopair.Octants.
py::tuple octants_tuple(const Octants& octants);

}  // namespace octopair::python
