#include "octree/dynamic/unit_blocks.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "octopair/error.hpp"

namespace octopair {

void UnitBlocks::clear() {
    heads_.clear();
    blocks_.clear();
    free_ = SmallBlock::none;
}

void UnitBlocks::release() {
    clear();
    heads_ = {};
    blocks_ = {};
}

std::uint32_t UnitBlocks::add(std::span<const std::uint32_t> sizes, std::span<const UnitEntry> entries) {
    const auto blocks_of = [](std::uint32_t size) {
        return std::uint32_t((size + SmallBlock::capacity - 1) / SmallBlock::capacity);
    };
    std::uint64_t blocks = 0;
    for (const std::uint32_t size : sizes) blocks += blocks_of(size);
    std::shared_lock filling(arrays_, std::defer_lock);
    const Place place = take_place(sizes.size(), blocks, filling);

    // The blocks of a unit lie side by side. They are filled from the last to the first, which may be filled only partly.
    std::vector<std::uint32_t> filled(sizes.size());  // by unit: the block that is filled
    std::uint32_t next = place.block;
    for (std::size_t unit = 0; unit < sizes.size(); ++unit) {
        const std::uint32_t begin = next;
        next += blocks_of(sizes[unit]);
        heads_[place.unit + unit] = begin == next ? SmallBlock::none : begin;
        for (std::uint32_t block = begin; block < next; ++block) {
            blocks_[block].next = block + 1 == next ? SmallBlock::none : block + 1;
            blocks_[block].count = 0;
        }
        filled[unit] = next - 1;
    }
    for (const UnitEntry& entry : entries) {
        std::uint32_t& block = filled[entry.unit];
        if (blocks_[block].count == SmallBlock::capacity) --block;
        blocks_[block].set(blocks_[block].count++, entry.box, entry.object);
    }
    return place.unit;
}

/// Takes numbers for units and blocks. Locks `filling`, so that the arrays stay where they are until it is unlocked.
UnitBlocks::Place UnitBlocks::take_place(std::size_t units, std::uint64_t blocks,
                                         std::shared_lock<std::shared_mutex>& filling) {
    for (;;) {
        filling.lock();
        {
            const std::lock_guard lock(mutex_);
            const Place place{std::uint32_t(heads_.size()), std::uint32_t(blocks_.size())};
            if (units <= heads_.capacity() - heads_.size() && blocks <= blocks_.capacity() - blocks_.size()) {
                heads_.grow(units);
                blocks_.grow(std::size_t(blocks));
                return place;
            }
        }
        filling.unlock();
        const std::unique_lock moving(arrays_);
        reserve(blocks, units);
    }
}

void UnitBlocks::reserve(std::uint64_t puts, std::uint64_t units) {
    const std::uint64_t most = std::max(blocks_.size() + puts, heads_.size() + units);
    if (most >= SmallBlock::none) throw Error(ErrorCode::resource_limit, "too many entries in an octree");
    blocks_.reserve(std::size_t(blocks_.size() + puts));
    heads_.reserve(std::size_t(heads_.size() + units));
}

void UnitBlocks::put(std::uint32_t unit, const SmallBox& entry, std::uint32_t object) {
    std::uint32_t& head = heads_[unit];
    if (head == SmallBlock::none || blocks_[head].count == SmallBlock::capacity) head = new_block(head);
    SmallBlock& block = blocks_[head];
    block.set(block.count++, entry, object);
}

void UnitBlocks::take(std::uint32_t unit, std::uint32_t object) {
    std::uint32_t& head = heads_[unit];
    for (std::uint32_t at = head; at != SmallBlock::none; at = blocks_[at].next) {
        SmallBlock& block = blocks_[at];
        for (std::uint32_t i = 0; i < block.count; ++i) {
            if (block.objects[i] != object) continue;
            SmallBlock& first = blocks_[head];
            const std::uint32_t last = --first.count;
            block.set(i, first.box(last), first.objects[last]);
            if (last == 0) free_block(std::exchange(head, first.next));
            return;
        }
    }
    throw Error(ErrorCode::engine_failed,
                "object " + std::to_string(object) + ": no entry in a unit that its box touches");
}

std::uint32_t UnitBlocks::new_block(std::uint32_t next) {
    const std::lock_guard lock(mutex_);
    std::uint32_t block = free_;
    if (block != SmallBlock::none) {
        free_ = blocks_[block].next;
    } else {
        block = std::uint32_t(blocks_.size());
        blocks_.grow();
    }
    blocks_[block].next = next;
    blocks_[block].count = 0;
    return block;
}

void UnitBlocks::free_block(std::uint32_t block) {
    const std::lock_guard lock(mutex_);
    blocks_[block].next = std::exchange(free_, block);
}

void UnitBlocks::prefetch_head(std::uint32_t unit) const { hwy::Prefetch(&heads_[unit]); }

void UnitBlocks::prefetch_first(std::uint32_t unit) const { prefetch_block(heads_[unit]); }

void UnitBlocks::prefetch_next(std::uint32_t unit) const {
    if (!empty(unit)) prefetch_block(blocks_[heads_[unit]].next);
}

void UnitBlocks::prefetch_block(std::uint32_t block) const {
    if (block == SmallBlock::none) return;
    constexpr std::size_t line = 64;
    const char* const begin = reinterpret_cast<const char*>(&blocks_[block]);
    for (std::size_t at = 0; at < sizeof(SmallBlock); at += line) hwy::Prefetch(begin + at);
}

}  // namespace octopair
