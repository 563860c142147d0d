// The memory behind a PairList: blocks that writers fill side by side, and the chunks that make up the list.
//
// A block belongs to one writer at a time; `chunks` are runs within blocks, in the order of the list. reset() forgets
// the chunks and keeps the blocks, so that a reused list does not page-fault again.
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

    /// Asked before memory is taken for a block, with its bytes; what it throws is thrown on.
    void ask(std::function<void(std::uint64_t bytes)> room) { room_ = std::move(room); }
    /// Empty, with all blocks free.
    void reset();
    /// A free block of at least `pairs` pairs, until the next reset. Thread-safe.
    std::span<Pair> take_block(std::size_t pairs);
    /// The same pairs in memory of the list's own.
    std::span<const Pair> copy(std::span<const Pair> pairs);
    /// Keeps memory that chunks lie in, until the next reset.
    void keep(std::shared_ptr<const void> memory) { kept_ = std::move(memory); }
    /// Makes `pairs` the next chunk. Adjoining chunks grow together.
    void append(std::span<const Pair> pairs);

private:
    std::mutex mutex_;
    std::function<void(std::uint64_t)> room_;
    std::vector<Buffer<Pair>> blocks_;
    std::shared_ptr<const void> kept_;
    std::span<Pair> free_;   // of the block that copies go to
    std::size_t taken_ = 0;  // blocks_[0, taken_) are in writers' hands
};

}  // namespace octopair::detail
