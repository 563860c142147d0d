// ScanMemory: the arrays that a scan of octants fills. ScanMemoryPool keeps these arrays allocated between scans.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

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

/// Thread safety: any thread may call it.
class ScanMemoryPool {
    struct GiveBack {
        ScanMemoryPool* pool;
        void operator()(ScanMemory* memory) const noexcept { pool->give_back(memory); }
    };

public:
    /// Memory that the pool lends. Its destructor gives the memory back to the pool. Requires: the pool still exists then.
    using Lent = std::unique_ptr<ScanMemory, GiveBack>;

    /// Returns free memory, or allocates memory if none is free. Throws: std::bad_alloc.
    Lent lend() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            free_.reserve(allocated_ + 1);  // so that give_back() needs no memory
            free_.push_back(std::make_unique<ScanMemory>());
            ++allocated_;
        }
        Lent lent(free_.back().release(), GiveBack{this});
        free_.pop_back();
        return lent;
    }

private:
    void give_back(ScanMemory* memory) noexcept {
        const std::lock_guard lock(mutex_);
        free_.emplace_back(memory);
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<ScanMemory>> free_;
    std::size_t allocated_ = 0;  // number of all ScanMemory objects, free and lent
};

}  // namespace octopair
