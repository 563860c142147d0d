// Random outlines of faces with exact coordinates, and exact facts about them.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "octopair/pose.hpp"

namespace octopair::test {

__extension__ using Wide = __int128;

/// A closed way through places with whole coordinates, of at most 46 bits.
using WholePlace = std::array<std::int64_t, 3>;
using WholeOutline = std::vector<WholePlace>;

/// Returns the places, times 2^-20.
std::vector<Point3d> places_of(const WholeOutline& outline);
std::string text(const WholeOutline& outline);

/// Returns the outline of a random face in a random plane, clockwise or not. It does not cross itself. It may touch itself, along edges,
/// too, and have holes with bridges, spikes, corners at one place in a row and corners in line.
WholeOutline random_outline(std::mt19937_64& random);
/// Returns an outline in the plane z = 0 through 4 to `most` random places of a grid of 5 x 5. Most cross themselves.
WholeOutline random_walk(unsigned most, std::mt19937_64& random);

/// Returns twice the area vector.
std::array<Wide, 3> whole_area_of(const WholeOutline& outline);
/// Returns the axis along which an area vector is largest.
unsigned main_axis(const std::array<Wide, 3>& area);
/// Returns 1 if c is left of the line from a to b, seen along the axis; -1: right; 0: on the line.
int side_of(const std::array<WholePlace, 3>& places, unsigned axis);

/// Returns how often the outline goes round a place, seen along the axis. `on_outline`: set to whether the place is on the outline.
int winding_of(const WholeOutline& outline, const WholePlace& place, unsigned axis, bool& on_outline);
/// Returns whether two edges cross in one point that is an end of neither, seen along z.
bool has_crossing(const WholeOutline& outline);
/// Returns whether winding numbers besides edges are not all 0 or 1, or 0 or -1. Requires: the outline is a random_walk().
bool overlaps(const WholeOutline& outline);

}  // namespace octopair::test
