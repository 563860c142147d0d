// TicketLock: a fair lock that runs the calls of an engine one after another.
//
// Invariants
//   Threads get the lock in the order of their tickets, so many queued jobs cannot starve direct calls.
//   A waiting thread can be stopped, unlike a thread that waits for a mutex.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

class TicketLock {
public:
    /// Holds the lock while it exists.
    class Guard {
    public:
        /// Waits until all earlier guards are released.
        /// Throws: Error{cancelled} if `stop` is requested while it waits; std::bad_alloc.
        Guard(TicketLock& lock, std::stop_token stop) : lock_(lock) {
            std::unique_lock mutex_lock(lock_.mutex_);
            auto& tickets = lock_.tickets_;
            const std::uint64_t ticket = lock_.next_ticket_++;
            tickets.push_back(ticket);
            const auto is_front = [&] { return tickets.front() == ticket; };
            if (is_front() || lock_.changed_.wait(mutex_lock, std::move(stop), is_front)) return;
            // No notification is needed: this ticket is not the front one, so its removal lets no other thread continue.
            tickets.erase(std::find(tickets.begin(), tickets.end(), ticket));
            throw Error(ErrorCode::cancelled, "cancelled");
        }
        Guard(const Guard&) = delete;
        Guard& operator=(const Guard&) = delete;
        ~Guard() {
            const std::lock_guard mutex_lock(lock_.mutex_);
            lock_.tickets_.pop_front();
            if (!lock_.tickets_.empty()) lock_.changed_.notify_all();
        }

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
