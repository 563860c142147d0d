// Sweeps of sets that are too large or too crowded for a single sweep: in tiles, and recursively.
//
// part_by_shape parts boxes by the axes on which they are long. Two families of rods defeat every sweep of the whole set;
// one sweep along the axis on which both families are thin joins them.
//
// tiled_sweep runs one sweep along an axis over large sets. A tile of 4,096 rows is swept against one tile of columns after
// another. A share is up to 8 tiles of rows. So scratch memory does not grow with the set, and one crowded octant occupies all
// threads.
//
// recursive_sweep is the guaranteed fallback, O(m log^2 m + pairs), for sets that no axis and no split can thin (rods that
// cross). It settles one axis after the other:
//   A pair is found at the box whose interval holds the other box's low end.
//   Rows that span the low ends of all columns have settled the axis. They are joined on the next axes alone.
//   The other rows, and the columns, are split at the median of the columns' low ends.
//   The orientation of a pair on settled axes is checked at the end, so each pair is found once.
//   The recursion ends where a sweep along some axis is cheap, or is about as large as its result.
// Source: Zomorodian, Edelsbrunner 2002, "Fast software for box intersections" (the hybrid algorithm), restated with total
// orders in place of symbolic perturbation.
#pragma once

#include <array>
#include <vector>

#include "octree/executor.hpp"
#include "octree/sweep/sweep_choice.hpp"

namespace octopair {

/// Finds the pairs of `join` by one sweep along `axis`, tile by tile. Throws: Error{cancelled}.
void tiled_sweep(const ScanContext& context, const SweepInput& join, unsigned axis, Executor& executor);

/// Divides the entries of a list into eight groups by shape, and returns the positions of each group. Bit k of a group's number: its
/// boxes are longer on axis k than a quarter of the list's extent.
/// Throws: Error{cancelled}.
std::array<std::vector<std::uint32_t>, 8> part_by_shape(const EntryList& list, const std::stop_token& stop);

/// Finds the pairs of `join` by the recursion that the head of this file describes. Requires: `join` has no orientation.
/// Throws: Error{cancelled}.
void recursive_sweep(const ScanContext& context, const SweepInput& join, Executor& executor);

}  // namespace octopair
