// Sweeps of sets too large or too crowded for one: in tiles, and recursively.
//
// part_by_shape parts boxes by the axes on which they are long: two families of rods that defeat every sweep of the
// whole are joined by one along the axis on which both are thin.
//
// A SweepInput asks for the overlapping pairs within a set (self), or between rows and columns.
//
// tiled_sweep runs one sweep along an axis whose sets may be large: shares of 4,096 rows, each passing over tiles of
// columns, so scratch memory does not grow with the set and one crowded octant occupies all threads.
//
// recursive_sweep is the guaranteed fallback, O(m log^2 m + pairs), for sets that no axis and no split can thin (rods
// that cross). On one axis after the other it finds each pair at the box whose interval holds the other's low end: rows
// that span all columns' low ends need no more of that axis and are joined on the next axes alone; the others are split
// at the median of the low ends. The pair's orientation on settled axes is checked at the end, so each pair is found
// once. Where a sweep along some axis is cheap, or about as large as its result, it ends there. Source: Zomorodian,
// Edelsbrunner 2002, "Fast software for box intersections" (the hybrid algorithm), restated with total orders in place
// of symbolic perturbation.
#pragma once

#include <array>
#include <vector>

#include "octree/sweep/pair_maker.hpp"
#include "octree/sweep/sweep_order.hpp"

namespace octopair {

struct SweepInput {
    EntryList rows;
    EntryList columns;  ///< self: the same list
    bool self = false;
    Orientation orientation = {};
};

/// The cheapest axis, and whether one sweep along it is as good as anything: its tests are few a box, or few a pair.
struct SweepChoice {
    unsigned axis = 0;
    bool good = false;
};

/// Throws Error{cancelled}.
SweepChoice choose_sweep(const SweepInput& join, SweepOrder& order, const std::stop_token& stop);

void tiled_sweep(const ScanContext& context, const SweepInput& join, unsigned axis, Executor& executor);

/// The positions of a list by the axes (as bits) on which a box is longer than a quarter of the list's reach.
std::array<std::vector<std::uint32_t>, 8> part_by_shape(const EntryList& list);

/// `join` has no orientation yet.
void recursive_sweep(const ScanContext& context, const SweepInput& join, Executor& executor);

}  // namespace octopair
