// Shapes as Python objects: a geometry, and objects that have geometries and poses.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <vector>

#include "octopair/shapes.hpp"

namespace octopair::python {

namespace py = pybind11;

/// Objects with shapes, and references to their arrays.
class PythonShapes {
public:
    /// `columns` is (geometry, poses, end poses, padding): uint32 (n), float64 (n, 3, 4), the same or None, float64 (n) or None.
    /// Throws: Error{bad_input} as octopair::check().
    PythonShapes(std::vector<Geometry> geometries, py::tuple columns);
    PythonShapes(const PythonShapes&) = delete;
    PythonShapes& operator=(const PythonShapes&) = delete;

    const ShapedObjects& objects() const { return objects_; }
    /// Returns the boxes of the objects, and of both sets for a join.
    py::array boxes() const;
    py::tuple boxes_with(const PythonShapes& second) const;

private:
    std::vector<Geometry> geometries_;
    py::tuple columns_;
    ShapedObjects objects_;
};

}  // namespace octopair::python
