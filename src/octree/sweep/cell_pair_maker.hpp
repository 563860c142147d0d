// CellPairMaker: turns the hits of cell sweeps into pairs of the caller's objects, for one share of the work.
#pragma once

#include <cstdint>
#include <span>

#include "base/memory.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/cell_sweep.hpp"
#include "octree/sweep/pair_maker.hpp"

namespace octopair {

/// Thread safety: one thread at a time.
class CellPairMaker {
public:
    /// Memory of sweep(). The constructor sets its size.
    struct Memory {
        Buffer<CellHit> hits;
        Buffer<Pair> pairs;
        Buffer<std::uint32_t> doubtful, refused;
    };
    /// Borrows `context` and `memory`.
    CellPairMaker(const ScanContext& context, Memory& memory);

    /// Runs a sweep to its end and passes its pairs to `writer`.
    /// Throws: Error{cancelled}.
    void sweep(const CellSweep& sweep, const CertainGaps& gaps, ShareWriter& writer);

private:
    std::size_t drop_refused(JudgedHits& judged);
    void check(std::span<const Pair> pairs) const;

    const ScanContext& context_;
    Memory& memory_;
};

}  // namespace octopair
