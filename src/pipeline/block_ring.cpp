#include "pipeline/block_ring.hpp"

#include <system_error>
#include <utility>

#include "base/floating_point_scope.hpp"

namespace octopair {

BlockRing::BlockRing(unsigned threads, Step work, Step deliver)
    : threads_(threads), work_(std::move(work)), deliver_(std::move(deliver)), slots_(length(threads)) {
    helpers_.reserve(threads_ - 1);
}

BlockRing::~BlockRing() {
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        added_.notify_all();
    }
    for (std::thread& helper : helpers_) helper.join();
}

Block& BlockRing::empty_block() {
    while (filled_ == head_ + slots_.size()) advance();
    return slot(filled_).block;
}

void BlockRing::add() {
    bool others_wait = false;
    {
        const std::lock_guard lock(mutex_);
        ++filled_;
        if (idle_ > 0) {
            added_.notify_one();
        } else {
            others_wait = filled_ > claimed_ + 1;  // this thread processes the first of the waiting blocks
        }
    }
    if (others_wait && may_start_ && helpers_.size() + 1 < threads_) start_helper();
}

void BlockRing::start_helper() {
    try {
        helpers_.emplace_back([this] { help(); });
    } catch (const std::system_error&) {
        may_start_ = false;  // no more threads are available: continue with the present threads
    }
}

void BlockRing::hand_out() {
    while (head_ < filled_ && head_is_done()) hand_out_head();
}

void BlockRing::finish() {
    while (head_ < filled_) advance();
}

bool BlockRing::head_is_done() {
    const std::lock_guard lock(mutex_);
    return slot(head_).done;
}

void BlockRing::hand_out_head() {
    Slot& head = slot(head_);
    if (head.failure) std::rethrow_exception(std::exchange(head.failure, nullptr));
    deliver_(head.block);
    head.done = false;  // needs no lock: no other thread reads `done` before the block is filled again
    ++head_;
}

/// Delivers the head if it is done. Otherwise processes a block or, if all blocks are claimed, waits for the head and delivers it.
void BlockRing::advance() {
    Slot* mine = nullptr;
    {
        std::unique_lock lock(mutex_);
        if (!slot(head_).done) {
            if (claimed_ < filled_) {
                mine = &slot(claimed_++);
            } else {
                caller_waits_ = true;
                done_.wait(lock, [&] { return slot(head_).done; });
                caller_waits_ = false;
            }
        }
    }
    if (mine == nullptr) return hand_out_head();
    work_at(*mine);
    const std::lock_guard lock(mutex_);
    mine->done = true;
}

void BlockRing::work_at(Slot& slot) noexcept {
    try {
        work_(slot.block);
    } catch (...) {
        slot.failure = std::current_exception();
    }
}

void BlockRing::help() {
    const FloatingPointScope scope;
    std::unique_lock lock(mutex_);
    for (;;) {
        while (!ended_ && claimed_ == filled_) {
            ++idle_;
            added_.wait(lock);
            --idle_;
        }
        if (ended_) return;
        Slot& mine = slot(claimed_++);
        lock.unlock();
        work_at(mine);
        lock.lock();
        mine.done = true;
        if (caller_waits_) done_.notify_one();
    }
}

}  // namespace octopair
