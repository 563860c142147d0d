// The desk's tables, as one process sees them: checked and committed access to what layout.hpp describes.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "engine/processes/shared_memory/layout.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

/// Shows in a worker's slot that it waits, as long as it lives.
class Waiting {
public:
    explicit Waiting(Slot& slot) : slot_(slot) { slot_.waits.store(1); }
    ~Waiting() { slot_.waits.store(0); }
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

private:
    Slot& slot_;
};

class DeskView {
public:
    /// `memory` must outlive it. Throws Error{engine_failed} if it is not a desk of this version.
    explicit DeskView(SharedMemory& memory);
    /// Makes `memory` a desk.
    static void lay_out(SharedMemory& memory, unsigned slots);

    Desk& desk() const { return *desk_; }
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
    Desk* desk_;
    Slot* slots_;
    unsigned slot_count_;
};

}  // namespace octopair
