// TicketLock: the calls of an engine one after another, in the order in which they came. Unlike at a mutex, whoever waits
// can be stopped, and nobody is passed over: direct calls and jobs alternate, however many jobs there are.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>

namespace octopair {

class TicketLock {
public:
    /// Held by the one whose turn it is.
    class Guard {
    public:
        /// Waits for all that came before. Throws Error{cancelled} if stopped meanwhile, std::bad_alloc.
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
    std::deque<std::uint64_t> tickets_;  // the first has its turn
    std::uint64_t next_ticket_ = 0;
};

}  // namespace octopair
