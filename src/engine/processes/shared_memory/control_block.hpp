// The control block's tables, as one process sees them: checked and committed access to what layout.hpp describes.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "engine/processes/shared_memory/layout.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

/// Shows in a worker's slot that it waits, as long as it lives.
class WaitingMark {
public:
    explicit WaitingMark(Slot& slot) : slot_(slot) { slot_.waits.store(1); }
    ~WaitingMark() { slot_.waits.store(0); }
    WaitingMark(const WaitingMark&) = delete;
    WaitingMark& operator=(const WaitingMark&) = delete;

private:
    Slot& slot_;
};

class ControlBlockView {
public:
    /// `memory` must outlive it. Throws Error{engine_failed} if it is not a control block of this version.
    explicit ControlBlockView(SharedMemory& memory);
    /// Makes `memory` a control block.
    static void lay_out(SharedMemory& memory, unsigned slots);

    ControlBlock& control_block() const { return *control_block_; }
    Slot& slot(unsigned i) const { return slots_[i]; }
    unsigned slots() const { return slot_count_; }

    /// Throws Error{resource_limit} where there is no room for them.
    std::span<Share> shares(std::uint64_t begin, std::uint64_t count) const;
    std::span<Run> runs(std::uint64_t begin, std::uint64_t count) const;
    std::span<LoggedPage> log(unsigned slot, std::uint64_t size) const;
    Commit& commit(unsigned slot, std::uint64_t number) const;
    RingEntry& ring_entry(unsigned slot, std::uint64_t number) const;

private:
    SharedMemory& memory_;
    ControlBlock* control_block_;
    Slot* slots_;
    unsigned slot_count_;
};

}  // namespace octopair
