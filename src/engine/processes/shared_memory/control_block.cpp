#include "engine/processes/shared_memory/control_block.hpp"

#include <unistd.h>

#include <cstring>
#include <new>
#include <string>

#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair {

namespace {

/// Throws: Error{resource_limit} unless [begin, begin + count) lies within [0, most).
void check_range(std::uint64_t begin, std::uint64_t count, std::uint64_t most) {
    if (begin <= most && count <= most - begin) return;
    throw Error(ErrorCode::resource_limit, "control block: a table of " + std::to_string(most) +
                                               " rows has no room for " + std::to_string(count) + " rows from row " +
                                               std::to_string(begin));
}

std::array<char, 32> version_text() {
    std::array<char, 32> text{};
    std::strncpy(text.data(), OCTOPAIR_VERSION, text.size() - 1);
    return text;
}

}  // namespace

void ControlBlockView::lay_out(SharedMemory& memory, unsigned slots) {
    ControlBlock* const control_block = new (memory.array<ControlBlock>(0, 1)) ControlBlock{};
    for (unsigned i = 0; i < slots; ++i) {
        new (memory.array<Slot>(ControlBlockLayout::slots + i * sizeof(Slot), 1)) Slot{};
    }
    control_block->mark = control_mark;
    control_block->layout = layout_version;
    control_block->version = version_text();
    control_block->client = ::getpid();
    control_block->slots = slots;
}

ControlBlockView::ControlBlockView(SharedMemory& memory)
    : memory_(memory), control_block_(memory.array<ControlBlock>(0, 1)) {
    slot_count_ = control_block_->slots.load();
    const bool fits = control_block_->mark == control_mark && control_block_->layout == layout_version &&
                      control_block_->version == version_text() && slot_count_ >= 1 && slot_count_ <= max_workers &&
                      memory.size() >= ControlBlockLayout::bytes(slot_count_);
    if (!fits) throw Error(ErrorCode::engine_failed, "the worker's program is of another version than the library");
    slots_ = memory.array<Slot>(ControlBlockLayout::slots, slot_count_);
}

std::span<Share> ControlBlockView::shares(std::uint64_t begin, std::uint64_t count) const {
    check_range(begin, count, max_shares);
    return {memory_.array<Share>(ControlBlockLayout::shares + begin * sizeof(Share), count), count};
}

std::span<Run> ControlBlockView::runs(std::uint64_t begin, std::uint64_t count) const {
    check_range(begin, count, max_runs);
    return {memory_.array<Run>(ControlBlockLayout::runs + begin * sizeof(Run), count), count};
}

std::span<LoggedPage> ControlBlockView::log(unsigned slot, std::uint64_t size) const {
    check_range(0, size, max_logged);
    return {memory_.array<LoggedPage>(ControlBlockLayout::logs + slot * max_logged * sizeof(LoggedPage), size), size};
}

Commit& ControlBlockView::commit(unsigned slot, std::uint64_t number) const {
    return *memory_.array<Commit>(ControlBlockLayout::commits + (2 * slot + number % 2) * sizeof(Commit), 1);
}

RingEntry& ControlBlockView::ring_entry(unsigned slot, std::uint64_t number) const {
    const std::uint64_t place = slot * max_ring_blocks + number % max_ring_blocks;
    return *memory_.array<RingEntry>(ControlBlockLayout::rings + place * sizeof(RingEntry), 1);
}

}  // namespace octopair
