// ScanMemory: the arrays in which octants are scanned. ScanMemoryPool keeps them, so that the next scan finds them allocated.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "octree/cell_sweep/cell_pair_maker.hpp"
#include "octree/cell_sweep/cell_set.hpp"

namespace octopair {

/// Its contents mean nothing to the next user.
struct ScanMemory {
    using Runs = std::vector<std::span<const CellEntry>>;
    Runs runs, next_runs;
    CellSet own_set, handed_set;
    std::vector<CellEntry> handed_cells;
    std::array<std::vector<CellEntry>, 4> cells_of_part;
    CellPairMaker::Memory pair_maker;
};

/// Thread safety: any thread may call it.
class ScanMemoryPool {
    struct GiveBack {
        ScanMemoryPool* pool;
        void operator()(ScanMemory* memory) const { pool->give_back(std::unique_ptr<ScanMemory>(memory)); }
    };

public:
    /// Returns to the pool when it is destroyed, which must be before the pool is.
    using Lent = std::unique_ptr<ScanMemory, GiveBack>;

    Lent lend() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) free_.push_back(std::make_unique<ScanMemory>());
        Lent lent(free_.back().release(), GiveBack{this});
        free_.pop_back();
        return lent;
    }

private:
    void give_back(std::unique_ptr<ScanMemory> memory) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(memory));
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<ScanMemory>> free_;
};

}  // namespace octopair
