// Arrays that grow. GrowingArray: a vector of plain data in a Buffer, so that a large array lies on huge pages. reserve_more(): reserves
// room in a vector before a change that must not fail half-way.
//
// With small pages, random access to tens of megabytes costs as much for address translation as for the memory itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"

namespace octopair {

/// Makes room for `more` additional elements. Doubles the capacity at least, so that repeated small calls do not copy each
/// time.
template <typename T>
void reserve_more(std::vector<T>& list, std::size_t more) {
    const std::size_t all = list.size() + more;
    if (all > list.capacity()) list.reserve(std::max(all, 2 * list.capacity()));
}

template <typename T>
class GrowingArray {
public:
    /// Makes room for `size` elements. Grows by at least half, so that repeated push_back() copies each element O(1) times.
    /// Throws: std::bad_alloc.
    void reserve(std::size_t size) {
        if (size <= memory_.size()) return;
        Buffer<T> larger(std::max(size, memory_.size() + memory_.size() / 2));
        if (size_ > 0) std::memcpy(larger.data(), memory_.data(), size_ * sizeof(T));
        memory_ = std::move(larger);
    }
    void resize(std::size_t size, const T& fresh) {
        reserve(size);
        std::fill(memory_.data() + std::min(size, size_), memory_.data() + size, fresh);
        size_ = size;
    }
    /// Appends uninitialised elements. Requires: they fit into the reserved memory.
    void grow(std::size_t count = 1) { size_ += count; }
    /// Removes all elements and keeps the memory.
    void clear() { size_ = 0; }
    void push_back(const T& element) {
        const T copy = element;  // `element` may be in this array
        reserve(size_ + 1);
        memory_[size_++] = copy;
    }

    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }
    /// Returns the number of elements for which there is room.
    std::size_t capacity() const { return memory_.size(); }
    std::span<const T> span() const { return {memory_.data(), size_}; }
    T& operator[](std::size_t i) { return memory_[i]; }
    const T& operator[](std::size_t i) const { return memory_[i]; }

private:
    Buffer<T> memory_;
    std::size_t size_ = 0;
};

}  // namespace octopair
