// Arena: arrays that every worker of a pass finds at the same place, because all of them reserve the same in the same
// order. Nothing is given back before the next job, so that a worker that takes over can follow the others.
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
    /// How much is reserved, and back to that.
    std::uint64_t mark() const { return used_; }
    void rewind(std::uint64_t mark) { used_ = mark; }
    std::uint64_t offset(const void* memory) const {
        return std::uint64_t(static_cast<const std::byte*>(memory) - memory_.data());
    }

private:
    SharedMemory& memory_;
    std::uint64_t used_ = 0;
};

}  // namespace octopair
