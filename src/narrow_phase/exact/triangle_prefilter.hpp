// A first look at many pairs of triangles: which of them float64 alone can tell to be apart, eight at a time where the
// processor can. Most pairs of a mesh are neighbours, or near each other in a smooth part of it, and end here.
#pragma once

#include <cstdint>
#include <span>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Bits of what a look has seen.
inline constexpr std::uint8_t look_apart = 1;   ///< without doubt, they have no point in common beyond shared corners
inline constexpr std::uint8_t look_shared = 2;  ///< they share a corner

struct TrianglePairs {
    std::span<const Triangle3d> first, second;
    std::span<const Pair> pairs;  ///< a of first, b of second; in range
};

/// Writes a look at each pair.
void look_at(const TrianglePairs& triangles, std::span<std::uint8_t> looks);

/// The specification of look_at.
///
/// Apart are triangles whose corners, but for the shared ones, are all on one side of the other's plane: what they have in
/// common is between corners that both have. Or a plane across the line between their middles separates them; through the
/// shared corner, if there is one.
std::uint8_t look_at(const Triangle3d& a, const Triangle3d& b);

}  // namespace octopair
