// UnitBlocks: stores the entries of each unit of a MutableOctree in blocks.
//
// Thread safety: threads may change different units concurrently. Functions without a unit need exclusive access.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <shared_mutex>
#include <span>

#include "base/growing_array.hpp"
#include "octree/dynamic/small_block.hpp"

namespace octopair {

/// An entry for add(), which adds units and their entries. `unit`: number of the entry's unit among the added units.
struct UnitEntry {
    std::uint32_t unit;
    std::uint32_t object;
    SmallBox box;
};

class UnitBlocks {
public:
    /// Removes all units and keeps the memory. Units that are added later are numbered from 0 on.
    void clear();
    /// Removes all units and frees the memory.
    void release();
    /// Adds units with their entries. `sizes`: number of entries of each unit. Returns the number of the first unit.
    /// Thread safety: any thread, while threads only add units.
    /// Throws: Error{resource_limit}; std::bad_alloc.
    std::uint32_t add(std::span<const std::uint32_t> sizes, std::span<const UnitEntry> entries);
    std::uint32_t units() const { return std::uint32_t(heads_.size()); }
    std::uint64_t blocks() const { return blocks_.size(); }
    /// Makes room for `puts` calls of put(), and for `units` more units.
    /// Throws: Error{resource_limit}; std::bad_alloc.
    void reserve(std::uint64_t puts, std::uint64_t units = 0);

    bool empty(std::uint32_t unit) const { return heads_[unit] == SmallBlock::none; }
    /// Adds an entry.
    /// Requires: reserve() has made room.
    void put(std::uint32_t unit, const SmallBox& entry, std::uint32_t object);
    /// Removes the entry of `object`.
    /// Throws: Error{engine_failed} if the unit has no entry of the object.
    void take(std::uint32_t unit, std::uint32_t object);
    /// Calls found(object) for each entry that overlaps `wanted`.
    template <typename Found>
    void search(std::uint32_t unit, const SmallBox& wanted, Found&& found) const;
    /// Calls visit(box, object) for each entry that overlaps `wanted`.
    template <typename Visit>
    void for_each(std::uint32_t unit, const SmallBox& wanted, Visit&& visit) const;

    // Three steps that prefetch the data of a unit for a later call. Call them in this order, with some time between two steps.
    void prefetch_head(std::uint32_t unit) const;
    void prefetch_first(std::uint32_t unit) const;
    void prefetch_next(std::uint32_t unit) const;

private:
    /// Numbers of the first new unit and of the first new block.
    struct Place {
        std::uint32_t unit, block;
    };
    Place take_place(std::size_t units, std::uint64_t blocks, std::shared_lock<std::shared_mutex>& filling);
    std::uint32_t new_block(std::uint32_t next);
    void free_block(std::uint32_t block);
    void prefetch_block(std::uint32_t block) const;

    std::shared_mutex arrays_;           // add(): shared lock to fill blocks, exclusive lock to move the arrays
    GrowingArray<std::uint32_t> heads_;  // first block of each unit
    std::mutex mutex_;  // guards the counts of units and blocks and the list of free blocks, not the contents of blocks
    GrowingArray<SmallBlock> blocks_;
    std::uint32_t free_ = SmallBlock::none;  // first of the free blocks
};

template <typename Found>
void UnitBlocks::search(std::uint32_t unit, const SmallBox& wanted, Found&& found) const {
    for (std::uint32_t at = heads_[unit]; at != SmallBlock::none; at = blocks_[at].next) {
        const SmallBlock& block = blocks_[at];
        for (std::uint32_t hits = overlapping(block, wanted); hits != 0; hits &= hits - 1) {
            found(block.objects[std::size_t(std::countr_zero(hits))]);
        }
    }
}

template <typename Visit>
void UnitBlocks::for_each(std::uint32_t unit, const SmallBox& wanted, Visit&& visit) const {
    for (std::uint32_t at = heads_[unit]; at != SmallBlock::none; at = blocks_[at].next) {
        const SmallBlock& block = blocks_[at];
        for (std::uint32_t hits = overlapping(block, wanted); hits != 0; hits &= hits - 1) {
            const auto i = std::size_t(std::countr_zero(hits));
            visit(block.box(i), block.objects[i]);
        }
    }
}

}  // namespace octopair
