#include "cli/command/interrupt.hpp"

#include <pthread.h>

#include "cli/command/program_main.hpp"

namespace octopair::cli {

Interrupt::Interrupt() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    // A shell starts background processes with SIGINT ignored, and sigwait() may not return for an ignored signal.
    std::signal(SIGINT, SIG_DFL);
    waiter_ = std::thread([this] { wait(); });
    // Wait until the thread runs. A starting thread allocates memory. If this process forked at that moment, the allocator's lock (of a
    // sanitizer) would stay locked in the child.
    waits_.wait();
}

Interrupt::~Interrupt() {
    finished_ = true;
    pthread_kill(waiter_.native_handle(), SIGINT);  // wakes the thread from sigwait()
    waiter_.join();
}

void Interrupt::wait() {
    waits_.count_down();
    int signal = 0;
    while (sigwait(&signals_, &signal) != 0) {
    }
    if (finished_) return;
    stop_signal = signal;
    stop_.request_stop();
    while (sigwait(&signals_, &signal) != 0) {
    }
    if (finished_) return;
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
    std::raise(signal);
}

}  // namespace octopair::cli
