// PairStorage: the memory of a PairList. Writers fill its blocks concurrently; chunks of the blocks form the list.
//
// Invariants
//   A block belongs to one writer at a time.
//   `chunks` are runs in the list's blocks or in kept memory, in the order of the list.
//   reset() clears the chunks and keeps the blocks, so a reused list causes no new page faults.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "octopair/pair_list.hpp"

namespace octopair::detail {

struct PairStorage {
    std::vector<std::span<const Pair>> chunks;
    std::uint64_t size = 0;

    /// A function that runs before each block is allocated, with the bytes of the block. Its exceptions propagate.
    using BeforeBlock = std::function<void(std::uint64_t bytes)>;
    /// Sets a function that limits the memory. Each block is then as small as possible.
    void ask(BeforeBlock room) { room_ = std::move(room); }
    /// Sets a function that only watches the memory.
    void watch(BeforeBlock watch) { watch_ = std::move(watch); }
    /// Returns the bytes of all blocks. Requires: no other thread takes a block.
    std::uint64_t held_bytes() const;
    /// Makes the list empty and all its blocks free.
    void reset();
    /// Makes the list empty and frees its memory.
    void release();
    /// Returns a free block of at least `pairs` pairs, valid until the next reset(). Thread safety: any thread.
    std::span<Pair> take_block(std::size_t pairs);
    /// Returns a copy of `pairs` in the list's blocks.
    std::span<const Pair> copy(std::span<const Pair> pairs);
    /// Keeps `memory`, which contains chunks of the list, until the next reset().
    void keep(std::shared_ptr<const void> memory) { kept_ = std::move(memory); }
    /// Appends `pairs` as the next chunk. Merges chunks that are adjacent in memory.
    void append(std::span<const Pair> pairs);
    /// Calls keep(pairs) for each chunk, which moves the pairs that stay to the front and returns their number.
    /// Requires: all chunks are in the list's blocks.
    template <typename Keep>
    void keep_some(const Keep& keep) {
        size = 0;
        for (std::span<const Pair>& chunk : chunks) {
            auto* const pairs = const_cast<Pair*>(chunk.data());  // NOLINT: the blocks are not constant
            chunk = chunk.first(keep(std::span(pairs, chunk.size())));
            size += chunk.size();
        }
        std::erase_if(chunks, [](std::span<const Pair> chunk) { return chunk.empty(); });
    }

private:
    std::size_t growth() const;

    std::mutex mutex_;
    BeforeBlock room_, watch_;
    std::vector<Buffer<Pair>> blocks_;
    std::shared_ptr<const void> kept_;
    std::span<Pair> free_;   // free part of the block that copy() fills
    std::size_t taken_ = 0;  // blocks_[0, taken_) are in use by writers
};

}  // namespace octopair::detail
