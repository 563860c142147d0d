// ControlBlockView: one process's view of the control block and its tables (layout.hpp). Checks and commits each access.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "engine/processes/shared_memory/layout.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

/// Scope guard: sets `Slot::waits` while the worker waits.
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
    /// Requires: `memory` outlives the view.
    /// Throws: Error{engine_failed} if `memory` is not a control block of this version.
    explicit ControlBlockView(SharedMemory& memory);
    /// Initialises `memory` as a control block with `slots` slots.
    static void lay_out(SharedMemory& memory, unsigned slots);

    ControlBlock& control_block() const { return *control_block_; }
    Slot& slot(unsigned i) const { return slots_[i]; }
    unsigned slots() const { return slot_count_; }

    // Access to rows of the tables. Throws: Error{resource_limit} if the table is too small for these rows.
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
