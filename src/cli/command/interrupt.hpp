// Interrupt: turns the first SIGINT or SIGTERM into a stop request. The second one kills the process.
//
// - The signals are blocked in all threads. One thread waits for them with sigwait().
// - So no code runs in a signal handler, and no system call is interrupted.
// - Requires: the Interrupt is made before the program starts any thread, because new threads inherit the mask that blocks signals.
#pragma once

#include <csignal>

#include <atomic>
#include <latch>
#include <stop_token>
#include <thread>

namespace octopair::cli {

class Interrupt {
public:
    Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
    ~Interrupt();

    std::stop_token token() const { return stop_.get_token(); }

private:
    void wait();

    sigset_t signals_;
    std::stop_source stop_;
    std::atomic<bool> finished_ = false;
    std::latch waits_{1};
    std::thread waiter_;
};

}  // namespace octopair::cli
