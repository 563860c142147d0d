// Errors of the library as exceptions of Python.
#pragma once

#include <pybind11/pybind11.h>

namespace octopair::python {

/// Makes the module raise the exceptions of octopair/_errors.py for Error and for a lack of memory. Each module needs this once.
void register_errors();

}  // namespace octopair::python
