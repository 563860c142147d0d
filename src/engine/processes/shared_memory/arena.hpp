// Arena: allocates arrays in shared memory, at the same offsets in all workers of a pass.
//
// Invariants
//   All workers reserve the same sizes in the same order, so each array has the same offset in each worker.
//   free() does nothing, so a replacement worker can repeat the same reservations. Only rewind() frees memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/memory.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

class Arena final : public PageSource {
public:
    explicit Arena(SharedMemory& memory) : memory_(memory) {}

    void* reserve(std::size_t bytes) override;
    void commit(void* memory, std::size_t bytes) override { memory_.commit(offset(memory), bytes); }
    void free(void*, std::size_t) noexcept override {}

    /// Number of bytes that can still be reserved.
    std::uint64_t left() const { return memory_.size() - used_; }
    /// Returns the number of reserved bytes. rewind() frees all that was reserved after the mark.
    std::uint64_t mark() const { return used_; }
    void rewind(std::uint64_t mark) { used_ = mark; }
    /// Returns the offset of `memory` in the arena, in bytes.
    std::uint64_t offset(const void* memory) const {
        return std::uint64_t(static_cast<const std::byte*>(memory) - memory_.data());
    }

private:
    SharedMemory& memory_;
    std::uint64_t used_ = 0;
};

}  // namespace octopair
