#include "octree/dynamic/unit_blocks.hpp"

#include <hwy/cache_control.h>

#include <string>
#include <utility>

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

void UnitBlocks::reserve(std::uint64_t puts) {
    const std::uint64_t wanted = blocks_.size() + puts;
    if (wanted >= SmallBlock::none) throw Error(ErrorCode::resource_limit, "too many entries in an octree");
    blocks_.reserve(std::size_t(wanted));
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
