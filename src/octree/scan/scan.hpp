// Scan: finds all pairs of a linear octree in one pass over its octants, in pre-order.
//
// Invariants
//   An octant's own entries are swept against each other and against the entries handed down to the octant. An entry that
//   is handed down touches the octant, but an octant above keeps it, because it is too large for smaller octants.
//   Two entries are compared only if they are in one octant, or if the octant of one entry is inside the octant of the other.
//   The masks of two entries decide which octant reports them as a pair (boxes/entry.hpp).
//
// octant_scan.hpp has the scan of one octant, handed_down.hpp the entries that are handed down. If a sweep of an octant would cost too
// much, the octant's entries are a crowd, which may become a nested linear octree (crowd.hpp).
//
// Source: Lucchesi, Egbert, Harris 2014, section 3.3, step 7.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "octree/build/linear_octree.hpp"
#include "octree/executor.hpp"
#include "octree/sweep/sweep.hpp"

namespace octopair {

/// The octants [begin, end) of an octree, in pre-order. Borrows the octree.
struct OctreeRange {
    OctreeRange(const LinearOctree& whole)  // NOLINT(google-explicit-constructor): a tree is a range of itself
        : OctreeRange(whole, 0, OctantIndex(whole.octants().size())) {}
    OctreeRange(const LinearOctree& tree, OctantIndex first, OctantIndex last)
        : octree(tree), begin(first), end(last) {}

    const LinearOctree& octree;
    OctantIndex begin, end;
};

struct ScanMemory;

/// Keeps the arrays that a scan of octants fills (octant_scan.hpp) allocated between scans.
/// Thread safety: any thread may call it.
class OCTOPAIR_PRIVATE_EXPORT ScanMemoryPool {
    struct GiveBack {
        ScanMemoryPool* pool;
        void operator()(ScanMemory* memory) const noexcept { pool->give_back(memory); }
    };

public:
    ScanMemoryPool();
    ~ScanMemoryPool();

    /// Memory that the pool lends. Its destructor gives the memory back to the pool. Requires: the pool still exists then.
    using Lent = std::unique_ptr<ScanMemory, GiveBack>;

    /// Returns free memory with undefined contents, or allocates memory if none is free. Throws: std::bad_alloc.
    Lent lend();

private:
    void give_back(ScanMemory* memory) noexcept;

    std::mutex mutex_;
    std::vector<std::unique_ptr<ScanMemory>> free_;
    std::size_t allocated_ = 0;  // number of all ScanMemory objects, free and lent
};

/// Writes the pairs that `octants` report, in pre-order of octants. From octants outside the range, reads only the entries
/// that are handed down into it. Calls `progress`, unless empty, with the number of entries of each finished share, on any
/// thread of the executor.
/// Throws: Error{cancelled}.
OCTOPAIR_PRIVATE_EXPORT void scan(const OctreeRange& octants, const ScanContext& context, Executor& executor,
                                  const std::function<void(std::uint64_t)>& progress);

}  // namespace octopair
