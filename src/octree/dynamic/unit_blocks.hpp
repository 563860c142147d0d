// UnitBlocks: stores the entries of each unit of a MutableOctree in blocks.
//
// Thread safety: threads may change different units concurrently. Functions without a unit need exclusive access.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <mutex>

#include "base/growing_array.hpp"
#include "octree/dynamic/small_block.hpp"

namespace octopair {

class UnitBlocks {
public:
    /// Removes all units and keeps the memory. Units that are added later are numbered from 0 on.
    void clear();
    /// Removes all units and frees the memory.
    void release();
    void add_units(std::size_t count) { heads_.resize(heads_.size() + count, SmallBlock::none); }
    std::uint32_t units() const { return std::uint32_t(heads_.size()); }
    std::uint64_t blocks() const { return blocks_.size(); }
    /// Makes room for `puts` calls of put().
    /// Throws: Error{resource_limit}; std::bad_alloc.
    void reserve(std::uint64_t puts);

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
    /// Calls visit(box, object) for each entry.
    template <typename Visit>
    void for_each(std::uint32_t unit, Visit&& visit) const;

    // Prefetch the data of a later call for the unit. The three are called in this order, with some time between them.
    void prefetch_head(std::uint32_t unit) const;
    void prefetch_first(std::uint32_t unit) const;
    void prefetch_next(std::uint32_t unit) const;

private:
    std::uint32_t new_block(std::uint32_t next);
    void free_block(std::uint32_t block);
    void prefetch_block(std::uint32_t block) const;

    GrowingArray<std::uint32_t> heads_;  // first block of each unit
    std::mutex mutex_;                   // guards the number of blocks and the list of free ones, not what is in blocks
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
void UnitBlocks::for_each(std::uint32_t unit, Visit&& visit) const {
    for (std::uint32_t at = heads_[unit]; at != SmallBlock::none; at = blocks_[at].next) {
        const SmallBlock& block = blocks_[at];
        for (std::size_t i = 0; i < block.count; ++i) visit(block.box(i), block.objects[i]);
    }
}

}  // namespace octopair
