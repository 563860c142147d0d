// OctantScan: finds the pairs that an octant reports, by sweeps on cells or as a crowd (crowd.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"
#include "octree/plan/octant_cells.hpp"
#include "octree/scan/crowd.hpp"
#include "octree/sweep/cell_sweep.hpp"

namespace octopair {

/// Memory that one share at a time uses to sweep octants. Octants that are too large for one sweep use other memory. The contents are
/// undefined when the pool lends the memory.
struct ScanMemory {
    using Runs = std::vector<std::span<const CellEntry>>;
    Runs runs, next_runs;                                 // entries of the scanned octant, and of the next octant
    CellSet own_set, handed_set;                          // own entries, and entries handed down, ready for a sweep
    std::vector<CellEntry> handed_cells;                  // entries handed down, with cells of the octant
    std::array<std::vector<CellEntry>, 4> cells_of_part;  // entries of a join, by OctantPart::number()
    CellPairMaker::Memory pair_maker;
};

/// Scans single octants.
/// Thread safety: one thread at a time.
class OctantScan {
public:
    /// Borrows all arguments but `context`.
    OctantScan(const LinearOctree& octree, const ScanContext& context, ScanMemory& memory, Executor& executor)
        : octree_(octree), context_(context), memory_(memory), executor_(executor) {}
    OctantScan(const OctantScan&) = delete;
    OctantScan& operator=(const OctantScan&) = delete;

    /// Finds the pairs among the octant's own entries, and of these with the entries `handed` down to it.
    /// Throws: Error{cancelled}.
    void scan(OctantIndex octant, std::span<const Entry> handed);

private:
    void find_runs(OctantIndex octant, ScanMemory::Runs& runs) const;
    void scan_self();
    void scan_join();
    void join(OctantPart rows, OctantPart columns);
    void scan_crowd(OctantPart rows, OctantPart columns);

    bool try_own_sweep();
    bool try_handed_sweep();
    bool try_cross_sweeps();
    bool try_sweep(std::initializer_list<CellSweep> sweeps);
    void collect_cells(OctantPart part);
    void turn_own();

    const LinearOctree& octree_;
    ScanContext context_;
    ScanMemory& memory_;
    Executor& executor_;
    OctantIndex octant_ = 0;
    OctantIndex runs_owner_ = ~OctantIndex(0);
    std::span<const Entry> handed_;
    OctantCells cells_;
    CellDepths depths_;
    unsigned turns_ = 0;  // number of times that the own entries, and depths_, were turned
    CellPairMaker pair_maker_{context_, memory_.pair_maker};
    std::optional<CrowdScan> crowd_scan_;  // empty until the first crowd
};

}  // namespace octopair
