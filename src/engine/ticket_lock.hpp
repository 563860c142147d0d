// TicketLock: a fair lock that runs the calls of an engine one after another.
//
// Invariants
//   Threads get the lock in the order of their tickets, so many queued jobs cannot starve direct calls.
//   A waiting thread can be stopped, unlike a thread that waits for a mutex.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>

#include "base/private_export.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT TicketLock {
public:
    /// Holds the lock while it exists.
    class Guard {
    public:
        /// Waits until all earlier guards are released.
        /// Throws: Error{cancelled} if `stop` is requested while it waits; std::bad_alloc.
        Guard(TicketLock& lock, std::stop_token stop);
        Guard(const Guard&) = delete;
        Guard& operator=(const Guard&) = delete;
        ~Guard();

    private:
        TicketLock& lock_;
    };

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<std::uint64_t> tickets_;  // the front ticket holds the lock
    std::uint64_t next_ticket_ = 0;
};

}  // namespace octopair
