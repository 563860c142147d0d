// This file has the parts that both kinds of sweep use. A sweep finds the overlapping boxes of sorted sets: it tests each row of one set
// against the columns that begin within the row on the first axis of the sweep.
//
//                                    on cells of an octant         on boxes in float32
//                                    (cell_sweep.hpp)              (box_sweep.hpp)
//   used for                         an ordinary octant            crowds (recursive_sweep.hpp)
//   sorted entries                   CellSet                       BoxSet
//   rows, columns and kind           CellSweep                     BoxSweep
//   where a sweep continues          CellCursor                    BoxCursor
//   find_hits() writes               CellHit: a row and a column   BoxHits: a column, and the rows of one block that hit it
//   certain_depths() returns         CellDepths                    Depths (boxes/entry.hpp)
//   judge_hits() finds the doubtful  among the pairs               among the hits
//   runs whole sweeps                CellPairMaker                 BoxPairMaker
//
// find_hits_scalar() and other functions whose names end in _scalar (specification.cpp) are the specification of the SIMD versions, which
// are in cell_sweep_kernel.cpp and box_sweep_kernel.cpp.
//
// Source: Lucchesi, Egbert, Harris 2014, section 2.3.1 (sweep and prune).
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "octree/sweep/scan_context.hpp"

namespace octopair {

/// The columns that a row is tested against. One cross sweep, and one cross_strict sweep with rows and columns exchanged, find each pair
/// of two sets once.
enum class SweepKind : std::uint8_t {
    self,          ///< row i against the columns i + 1, i + 2, ... of the same set
    cross,         ///< a row against the columns of another set that do not begin before the row
    cross_strict,  ///< a row against the columns of another set that begin after the row
};

/// Runs a sweep to its end. Calls take(hits) with the hits of each call of find_hits(), which writes them to `room`.
/// Requires: `room` has at least Sweep::min_room elements.
/// Throws: Error{cancelled}.
template <typename Sweep, typename Take>
void run_sweep(const Sweep& sweep, const std::stop_token& stop, std::span<typename Sweep::Hit> room, Take&& take) {
    typename Sweep::Cursor cursor;
    bool repeated = false;  // for Fault::sweep_repeats_block
    while (cursor.row < sweep.rows.size()) {
        take(room.first(find_hits(sweep, cursor, room)));
        if (cursor.row >= sweep.rows.size()) return;
        count_path(Sweep::resumed);
        throw_if_stopped(stop);
        if (planted(Fault::sweep_repeats_block) && !std::exchange(repeated, true)) cursor.in_row = false;
    }
}

/// Returns the instruction set that sweeps use on this machine, such as "AVX2".
std::string sweep_instruction_set();
/// For tests: true allows only the baseline instruction set, false allows all.
void restrict_sweep_to_baseline(bool baseline_only);

}  // namespace octopair
