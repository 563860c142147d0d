// Computes the boxes of spheres: centre - radius to centre + radius, rounded outward to the precision of the file.
//
//   float32  The sums are computed in float64, rounded to nearest. The box is the smallest float32 box that holds them.
//   float64  The box is the smallest float64 box that holds the exact sums.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string_view>

#include "octopair/objects.hpp"

namespace octopair::io {

/// A row of an (n, 4) array.
template <typename Real>
struct Sphere {
    Real centre[3];
    Real radius;
};

/// Returns the box of one sphere. A bound beyond the range of Real becomes infinite.
/// Requires: all numbers are finite, radius >= 0.
template <typename Real>
Box<Real> box_of_sphere(const Sphere<Real>& sphere);

/// Position of spheres in a file, for messages, and the stop token of their conversion.
struct SpherePlace {
    std::string_view file;
    std::uint64_t begin = 0;  ///< object number of the first sphere
    std::stop_token stop = {};
};

/// Writes the box of each sphere to `boxes`. Requires: both spans have the same size.
/// Throws: Error{bad_input} that names the file and the object for a number that is not finite, a negative radius, or a bound
/// beyond the range of Real; Error{cancelled} after a stop request.
template <typename Real>
void boxes_of_spheres(std::span<const Sphere<Real>> spheres, std::span<Box<Real>> boxes, const SpherePlace& place);

}  // namespace octopair::io
