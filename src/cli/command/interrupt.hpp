// SIGINT and SIGTERM as a stop request; the second one kills.
//
// The signals are blocked in every thread but taken by one that waits for them, so that nothing runs in a signal
// handler and no system call is cut short. Make it before any other thread: they inherit what is blocked.
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
