#include "engine/processes/shared_memory/desk.hpp"

#include <unistd.h>

#include <cstring>
#include <new>
#include <string>

#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair {

namespace {

/// Throws Error{resource_limit} unless [begin, begin + count) lies within [0, most).
void check_range(std::uint64_t begin, std::uint64_t count, std::uint64_t most) {
    if (begin <= most && count <= most - begin) return;
    throw Error(ErrorCode::resource_limit, "the worker processes' tables have no room for " + std::to_string(begin) +
                                               " + " + std::to_string(count) + " of " + std::to_string(most));
}

std::array<char, 32> version_text() {
    std::array<char, 32> text{};
    std::strncpy(text.data(), OCTOPAIR_VERSION, text.size() - 1);
    return text;
}

}  // namespace

void DeskView::lay_out(SharedMemory& memory, unsigned slots) {
    Desk* const desk = new (memory.array<Desk>(0, 1)) Desk{};
    for (unsigned i = 0; i < slots; ++i) {
        new (memory.array<Slot>(DeskPlaces::slots + i * sizeof(Slot), 1)) Slot{};
    }
    desk->mark = desk_mark;
    desk->layout = layout_version;
    desk->version = version_text();
    desk->client = ::getpid();
    desk->slots = slots;
}

DeskView::DeskView(SharedMemory& memory) : memory_(memory), desk_(memory.array<Desk>(0, 1)) {
    slot_count_ = desk_->slots.load();
    const bool fits = desk_->mark == desk_mark && desk_->layout == layout_version && desk_->version == version_text() &&
                      slot_count_ >= 1 && slot_count_ <= most_workers &&
                      memory.size() >= DeskPlaces::bytes(slot_count_);
    if (!fits) throw Error(ErrorCode::engine_failed, "the worker's program is of another version than the library");
    slots_ = memory.array<Slot>(DeskPlaces::slots, slot_count_);
}

std::span<Share> DeskView::shares(std::uint64_t begin, std::uint64_t count) const {
    check_range(begin, count, most_shares);
    return {memory_.array<Share>(DeskPlaces::shares + begin * sizeof(Share), count), count};
}

std::span<Run> DeskView::runs(std::uint64_t begin, std::uint64_t count) const {
    check_range(begin, count, most_runs);
    return {memory_.array<Run>(DeskPlaces::runs + begin * sizeof(Run), count), count};
}

std::span<LoggedPage> DeskView::log(unsigned slot, std::uint64_t size) const {
    check_range(0, size, most_logged);
    return {memory_.array<LoggedPage>(DeskPlaces::logs + slot * most_logged * sizeof(LoggedPage), size), size};
}

Commit& DeskView::commit(unsigned slot, std::uint64_t number) const {
    return *memory_.array<Commit>(DeskPlaces::commits + (2 * slot + number % 2) * sizeof(Commit), 1);
}

RingEntry& DeskView::ring_entry(unsigned slot, std::uint64_t number) const {
    const std::uint64_t place = slot * most_ring_blocks + number % most_ring_blocks;
    return *memory_.array<RingEntry>(DeskPlaces::rings + place * sizeof(RingEntry), 1);
}

}  // namespace octopair
