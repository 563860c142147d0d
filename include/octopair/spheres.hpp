// Boxes of spheres: centre - radius to centre + radius, rounded outward to the precision of the spheres. Files with spheres use the same
// function.
//
// float32   The sums are computed in float64, rounded to nearest. The box is the smallest float32 box that holds them.
// float64   The box is the smallest float64 box that holds the exact sums.
#pragma once

#include <span>
#include <stop_token>

#include "octopair/objects.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// A closed ball: a row of an (n, 4) array. All numbers are finite; radius >= 0.
template <typename Real>
struct SphereRow {
    Real centre[3];
    Real radius;
};

/// Writes the box of each sphere to `boxes`. Requires: both spans have the same size.
/// Throws: Error{bad_input} with the object, for a number that is not finite, a negative radius, or a bound beyond the range of the
/// number type; Error{cancelled} after a stop request.
void boxes_of(std::span<const SphereRow<float>> spheres, std::span<Box3f> boxes, std::stop_token stop = {});
void boxes_of(std::span<const SphereRow<double>> spheres, std::span<Box3d> boxes, std::stop_token stop = {});

}  // namespace octopair
