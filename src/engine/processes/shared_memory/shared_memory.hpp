// SharedMemory: memory that several processes share. An anonymous file (memfd) that each process maps. Arena: arrays in it.
//
// Invariants
//   The file has its maximum size from the start and is sealed: no process can shrink or grow it.
//   A range is committed before its first access. commit() throws if memory runs out, so no access raises SIGBUS.
//   Committed memory stays committed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "base/descriptor.hpp"
#include "base/memory.hpp"

namespace octopair {

/// Returns the size for files that must be created before their content is known. It is the memory of this machine, or less if limits
/// of the process (RLIMIT_FSIZE, RLIMIT_AS) require it.
std::uint64_t max_region_bytes();

class SharedMemory {
public:
    /// Creates a file of `bytes`. Throws: Error{resource_limit}.
    static SharedMemory create(std::uint64_t bytes);
    /// Maps a file that another process created.
    /// Throws: Error{engine_failed} unless its size is `bytes` and it is sealed; Error{resource_limit}.
    static SharedMemory open(Descriptor file, std::uint64_t bytes);

    SharedMemory(SharedMemory&& other) noexcept;
    SharedMemory& operator=(SharedMemory&&) = delete;
    ~SharedMemory();

    std::uint64_t size() const { return size_; }
    /// Returns the bytes that all processes have committed.
    std::uint64_t committed_bytes() const;
    int descriptor() const { return file_.number(); }
    std::byte* data() const { return data_; }
    bool contains(const void* memory) const {
        const auto* const byte = static_cast<const std::byte*>(memory);
        return byte >= data_ && byte < data_ + size_;
    }

    /// Commits and maps the bytes [offset, offset + bytes). Fast if they are already committed.
    /// Throws: Error{resource_limit} if memory runs out or the range exceeds the file.
    /// Thread safety: any thread.
    void commit(std::uint64_t offset, std::uint64_t bytes);

    /// Returns the array of `count` elements at byte `offset`, and commits it.
    /// Throws: Error{resource_limit} if memory runs out or the array exceeds the file.
    template <typename T>
    T* array(std::uint64_t offset, std::uint64_t count) {
        if (count > size_ / sizeof(T)) refuse(count);
        commit(offset, count * sizeof(T));
        return reinterpret_cast<T*>(data_ + offset);
    }

private:
    SharedMemory(Descriptor file, std::uint64_t bytes);
    [[noreturn]] void refuse(std::uint64_t bytes) const;
    void commit_granules(std::uint64_t begin, std::uint64_t end);

    static constexpr std::uint64_t granule = 1 << 16;  // bytes
    Descriptor file_;
    std::uint64_t size_ = 0;
    std::byte* data_ = nullptr;
    std::mutex mutex_;
    std::vector<bool> committed_;  // granules that this process has committed
};

/// Allocates arrays in shared memory, at the same offsets in all workers of a pass: all workers reserve the same sizes in the same
/// order. free() does nothing, so a replacement worker can repeat the same reservations. Only rewind() frees memory.
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
