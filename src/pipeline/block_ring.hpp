// BlockRing: a ring buffer of blocks that several threads process and the calling thread delivers in order.
//
//     empty_block() -> fill it -> add() -> `work` on any thread -> `deliver` on the calling thread, in order
//
// The calling thread fills and delivers blocks. If the ring is full, it also processes blocks. It waits only if other threads
// process all remaining blocks. The ring starts its own helper threads when there is work for them. It cannot use the threads
// of the engine: they may be blocked inside the search while a sink runs.
//
// Invariants
//   head_ <= claimed_ <= filled_ <= head_ + length of the ring.
//   Each block before claimed_ is done, or one thread processes it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "octopair/pipeline.hpp"

namespace octopair {

/// Statistics of one filter for one block.
struct FilterWork {
    std::uint64_t in = 0, out = 0;  ///< numbers of pairs before and after the filter
    double seconds = 0;
    std::uint64_t undecided = 0;  ///< pairs that the filter could not decide
};

struct Block {
    Batch batch;
    std::vector<FilterWork> work;  ///< one element for each filter
};

class BlockRing {
public:
    using Step = std::function<void(Block&)>;

    /// `work` runs on any thread, `deliver` on the calling thread. An exception of `work` is rethrown when its block would be
    /// delivered, so which exception is thrown does not depend on the number of threads.
    BlockRing(unsigned threads, Step work, Step deliver);
    BlockRing(const BlockRing&) = delete;
    BlockRing& operator=(const BlockRing&) = delete;
    /// Waits until helpers have processed the blocks that they have claimed.
    ~BlockRing();

    /// Returns the number of blocks in a ring for `threads` threads.
    static std::size_t length(unsigned threads) { return threads == 1 ? 1 : std::size_t(threads) * 4; }

    /// Returns the block to fill next. While the ring is full, processes and delivers blocks.
    Block& empty_block();
    /// Adds the block that empty_block() returned. Requires: it is filled.
    void add();
    /// Delivers blocks that are done, beginning at the head, until one is not done. Does not wait.
    void hand_out();
    /// Processes and delivers blocks until the ring is empty.
    void finish();

private:
    struct Slot {
        Block block;
        bool done = false;
        std::exception_ptr failure;
    };

    Slot& slot(std::uint64_t i) { return slots_[i % slots_.size()]; }
    bool head_is_done();
    void hand_out_head();
    void advance();
    void work_at(Slot& slot) noexcept;
    void help();
    void start_helper();

    const unsigned threads_;
    const Step work_, deliver_;
    std::vector<Slot> slots_;
    std::mutex mutex_;
    std::condition_variable added_, done_;
    std::uint64_t head_ = 0;     // next block to be delivered; used by the calling thread only
    std::uint64_t claimed_ = 0;  // next block to be processed
    std::uint64_t filled_ = 0;   // next block to be filled; modified by the calling thread only
    unsigned idle_ = 0;          // number of helpers that wait
    bool caller_waits_ = false;
    bool ended_ = false;
    bool may_start_ = true;
    std::vector<std::thread> helpers_;
};

}  // namespace octopair
