// Boxes of spheres: centre - radius to centre + radius, computed in float64 and rounded outward to the file's
// precision.
//
// float32: the sums are taken in float64 (rounded to nearest there); the box is the smallest of float32 that holds
// them. float64: the box is the smallest of float64 that holds the exact sums.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "octopair/objects.hpp"

namespace octopair::io {

/// A row of an (n, 4) array.
template <typename Real>
struct Sphere {
    Real centre[3];
    Real radius;
};

/// The box of one sphere, whose numbers are finite and whose radius is >= 0. An end beyond the range of Real is
/// infinite.
template <typename Real>
Box<Real> box_of_sphere(const Sphere<Real>& sphere);

/// Where spheres stand.
struct SpherePlace {
    std::string_view file;
    std::uint64_t begin = 0;  ///< the number of the first
};

/// The boxes of all. Throws Error{bad_input} that names the file and the object for a number that is not finite, a
/// negative radius, or an end beyond the range of Real.
template <typename Real>
void boxes_of_spheres(std::span<const Sphere<Real>> spheres, std::span<Box<Real>> boxes, const SpherePlace& place);

}  // namespace octopair::io
