// Buffers: arrays of plain data that are not initialised, and keep their memory when they are made smaller.
//
// Large ones are mapped on their own, so that their memory is the system's again as soon as they go (an allocator would
// keep it in pieces between others), and are asked to lie on huge pages, which gave 4 to 24% in measurements of the sort.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace octopair {

/// `bytes` of memory aligned to 64 bytes (2 MiB for large ones). Throws std::bad_alloc.
void* allocate_pages(std::size_t bytes);
/// `bytes` as when it was allocated.
void free_pages(void* memory, std::size_t bytes) noexcept;

/// Where buffers get their pages. Thread-safe.
class PageSource {
public:
    virtual ~PageSource() = default;
    /// As allocate_pages, but only pages that commit() was called for may be touched. Throws.
    virtual void* reserve(std::size_t bytes) = 0;
    /// Makes reserved memory fit for use, wherever it lies in what was reserved; no harm if it was before. Throws.
    virtual void commit(void* memory, std::size_t bytes) = 0;
    virtual void free(void* memory, std::size_t bytes) noexcept = 0;
};

/// Memory of this process. What is committed a few pages at a time takes no more than these: no huge pages.
PageSource& own_pages();

template <typename T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    Buffer() = default;
    explicit Buffer(std::size_t size) { resize_discard(size); }
    /// Empty; its pages come from `source`, which must outlive it.
    explicit Buffer(PageSource& source) : source_(&source) {}

    /// Makes the size `size`; what it held is lost where it grows beyond its capacity.
    void resize_discard(std::size_t size) {
        const bool grows = size > capacity();
        reserve_discard(size);
        if (grows) commit(0, size);
    }

    /// The same without any use of memory: before a part is touched it must be committed.
    void reserve_discard(std::size_t size) {
        if (size > capacity()) {
            clear();
            memory_ = {static_cast<T*>(source_->reserve(size * sizeof(T))), Free{size, source_}};
        }
        size_ = size;
    }
    void commit(std::size_t begin, std::size_t count) { source_->commit(data() + begin, count * sizeof(T)); }

    /// Empty, with its memory given back.
    void clear() noexcept {
        memory_.reset();
        size_ = 0;
    }

    std::size_t size() const { return size_; }
    T* data() { return memory_.get(); }
    const T* data() const { return memory_.get(); }
    std::span<T> span() { return {data(), size_}; }
    std::span<const T> span() const { return {data(), size_}; }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }

private:
    struct Free {
        std::size_t capacity = 0;
        PageSource* source = nullptr;
        void operator()(T* memory) const noexcept { source->free(memory, capacity * sizeof(T)); }
    };
    std::size_t capacity() const { return memory_ ? memory_.get_deleter().capacity : 0; }

    PageSource* source_ = &own_pages();
    std::unique_ptr<T, Free> memory_;
    std::size_t size_ = 0;
};

}  // namespace octopair
