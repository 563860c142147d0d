// Memory that processes share: a file without a name (memfd), mapped by each of them.
//
// A file is made as large as it may ever become, and sealed so that nobody can shrink or grow it: no access within it can
// fail for its size. Memory is given to it piece by piece, before it is touched (commit): where there is none left,
// commit() throws, and no access later dies of a bus error. What was given is kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "base/descriptor.hpp"

namespace octopair {

/// How large a file is made that may have to hold anything: the memory of this machine, or less where the process may
/// not map so much.
std::uint64_t roomy_bytes();

class SharedMemory {
public:
    /// A new file of `bytes`. Throws Error{resource_limit}.
    static SharedMemory create(std::uint64_t bytes);
    /// One that another process made. Throws Error{engine_failed} unless it is of this size, and sealed.
    static SharedMemory open(Descriptor file, std::uint64_t bytes);

    SharedMemory(SharedMemory&& other) noexcept;
    SharedMemory& operator=(SharedMemory&&) = delete;
    ~SharedMemory();

    std::uint64_t size() const { return size_; }
    int descriptor() const { return file_.number(); }
    std::byte* data() const { return data_; }
    bool contains(const void* memory) const {
        const auto* const byte = static_cast<const std::byte*>(memory);
        return byte >= data_ && byte < data_ + size_;
    }

    /// Makes [offset, offset + bytes) fit for use, here and now; soon done where it is already. Thread-safe. Throws
    /// Error{resource_limit}, also where the range is not within the file.
    void commit(std::uint64_t offset, std::uint64_t bytes);

    /// An array within the file, committed. Throws Error{resource_limit} where it is not within it.
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
    std::vector<bool> committed_;  // granules, as far as this process knows
};

}  // namespace octopair
