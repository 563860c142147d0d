// The box of a sphere, for boxes_of() and for files with spheres. Rounding: octopair/spheres.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "octopair/spheres.hpp"

namespace octopair {

/// Returns the box of one sphere. A bound beyond the range of Real becomes infinite.
/// Requires: all numbers are finite, radius >= 0.
template <typename Real>
Box<Real> box_of_sphere(const SphereRow<Real>& sphere);

/// Writes the box of each sphere to `boxes`. `begin`: index of the first sphere, for messages.
/// Requires: both spans have the same size. Throws: as boxes_of().
template <typename Real>
void write_sphere_boxes(std::span<const SphereRow<Real>> spheres, std::span<Box<Real>> boxes, std::uint64_t begin,
                        const std::stop_token& stop);

}  // namespace octopair
