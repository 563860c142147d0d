// BlockRow: blocks on their way, worked at by several threads and handed out in order.
//
//     room() -> fill it -> add() -> work on any thread -> deliver on the calling thread, in order
//
// The calling thread fills blocks and hands them out; when the row is full it works itself, and waits only where others have
// all the blocks in their hands. Helpers are threads of the row's own, started when there is work for them: those of an engine
// may be blocked inside its search while a sink runs, and its scheduler has no others to give.
// Invariant: head_ <= claimed_ <= filled_ <= head_ + the row's length; blocks before claimed_ are done or in someone's hands.
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

/// What one filter did to one block.
struct FilterWork {
    std::uint64_t in = 0, out = 0;
    double seconds = 0;
};

struct Block {
    Batch batch;
    std::vector<FilterWork> work;  ///< by filter
};

class BlockRow {
public:
    using Step = std::function<void(Block&)>;

    /// `work` is called on any thread, `deliver` on the calling one. What `work` throws is thrown where its block would have
    /// been delivered, so that it does not depend on threads.
    BlockRow(unsigned threads, Step work, Step deliver);
    BlockRow(const BlockRow&) = delete;
    BlockRow& operator=(const BlockRow&) = delete;
    /// Waits for the blocks that helpers have in their hands.
    ~BlockRow();

    static std::size_t length(unsigned threads) { return threads == 1 ? 1 : std::size_t(threads) * 4; }

    /// The block to fill next. Works and hands out until there is one.
    Block& room();
    /// The block of room() is filled.
    void add();
    /// Hands out what is done; does not wait.
    void hand_out();
    /// Works and hands out until the row is empty.
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
    std::uint64_t head_ = 0;     // next to be handed out; the calling thread's
    std::uint64_t claimed_ = 0;  // next to be worked at
    std::uint64_t filled_ = 0;   // next to be filled; the calling thread's to change
    unsigned idle_ = 0;          // helpers that wait
    bool leading_waits_ = false;
    bool ended_ = false;
    bool may_start_ = true;
    std::vector<std::thread> helpers_;
};

}  // namespace octopair
