// Turns: the calls of an engine one after another, in the order in which they came. Unlike at a mutex, whoever waits
// can be stopped, and nobody is passed over: direct calls and jobs alternate, however many jobs there are.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>

namespace octopair {

class Turns {
public:
    /// Held by the one whose turn it is.
    class Turn {
    public:
        /// Waits for all that came before. Throws Error{cancelled} if stopped meanwhile, std::bad_alloc.
        Turn(Turns& turns, std::stop_token stop);
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        ~Turn();

    private:
        Turns& turns_;
    };

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<std::uint64_t> tickets_;  // the first has its turn
    std::uint64_t next_ticket_ = 0;
};

}  // namespace octopair
