// Collision table: the pairs and findings of batches, in columns.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <vector>

#include "octopair/pipeline.hpp"

namespace octopair::python {

namespace py = pybind11;

/// Appends batches. Each column has a row per pair; columns of contacts have a row per contact.
class CollisionColumns {
public:
    void append(const Batch& batch);
    std::size_t size() const { return pairs_.size(); }
    /// Returns a dict of arrays by the names of octopair.Collisions, and is empty afterwards.
    py::dict take();

private:
    void append(const Finding& finding);

    std::vector<Pair> pairs_;
    std::vector<std::uint8_t> classes_, depth_kinds_, thickness_kinds_;
    std::vector<double> distances_, depths_, depths_at_most_, thicknesses_, times_;
    std::vector<std::array<Point3d, 2>> nearest_;
    std::vector<std::array<bool, 2>> open_;
    std::vector<std::uint64_t> notes_;
    std::vector<std::uint8_t> more_contacts_;
    std::vector<std::int64_t> offsets_ = {0};
    std::vector<Point3d> points_, normals_;
    std::vector<double> contact_depths_;
    std::vector<std::array<std::uint32_t, 2>> features_;
};

}  // namespace octopair::python
