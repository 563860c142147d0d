// UnitBlocks: the entries of each unit of a MutableOctree, in blocks.
//
// Threads may change different units at the same time; calls that name no unit are for one thread alone.
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
    /// Empties it; units are numbered from 0 on as they are added. Keeps its memory.
    void clear();
    /// And gives it back.
    void release();
    void add_units(std::size_t count) { heads_.resize(heads_.size() + count, SmallBlock::none); }
    std::uint32_t units() const { return std::uint32_t(heads_.size()); }
    std::uint64_t blocks() const { return blocks_.size(); }
    /// Room for so many calls of put(). Throws Error{resource_limit}, std::bad_alloc.
    void reserve(std::uint64_t puts);

    bool empty(std::uint32_t unit) const { return heads_[unit] == SmallBlock::none; }
    void put(std::uint32_t unit, const SmallBox& entry, std::uint32_t object);
    /// Throws Error{engine_failed} if it is not there.
    void take(std::uint32_t unit, std::uint32_t object);
    /// Calls found(object) for those that overlap.
    template <typename Found>
    void search(std::uint32_t unit, const SmallBox& wanted, Found&& found) const;
    /// Calls visit(box, object) for all.
    template <typename Visit>
    void for_each(std::uint32_t unit, Visit&& visit) const;

    // What is fetched from memory for a call that follows: the three one after the other, each with some time between.
    void prefetch_head(std::uint32_t unit) const;
    void prefetch_first(std::uint32_t unit) const;
    void prefetch_next(std::uint32_t unit) const;

private:
    std::uint32_t new_block(std::uint32_t next);
    void free_block(std::uint32_t block);
    void prefetch_block(std::uint32_t block) const;

    GrowingArray<std::uint32_t> heads_;  // first block of each unit
    std::mutex mutex_;                   // of the number and the list of free ones; a block itself is its unit's
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
