// Prefilter of triangle pairs: finds pairs that float64 proves to be apart. The other pairs need the exact test.
//
// It tests up to eight pairs at a time with SIMD instructions. Most pairs of a mesh are neighbours, or close to each other in a
// smooth part of the mesh; the prefilter decides these.
#pragma once

#include <cstdint>
#include <span>

#include "octopair/objects.hpp"
#include "octopair/pose.hpp"

namespace octopair {

/// Bits of the result for one pair.
inline constexpr std::uint8_t prefilter_apart = 1;   ///< proven: no common point other than shared corners
inline constexpr std::uint8_t prefilter_shared = 2;  ///< the triangles share a corner

struct TrianglePairs {
    std::span<const Triangle3d> first, second;
    std::span<const Pair> pairs;  ///< a: index in `first`, b: index in `second`; all in range
};

/// Writes the result bits of each pair to `flags`, which has the size of `pairs`.
void prefilter_pairs(const TrianglePairs& triangles, std::span<std::uint8_t> flags);

/// Returns the result bits of one pair. This is the specification of prefilter_pairs().
///
/// Two triangles are apart if all corners of one, except shared ones, are on one side of the other's plane. Then all common
/// points lie between shared corners. They are also apart if a plane perpendicular to the line between their centroids
/// separates them. With a shared corner, that plane passes through it.
std::uint8_t prefilter_pair(const Triangle3d& a, const Triangle3d& b);

}  // namespace octopair
