#include "cli/command/interrupt.hpp"

#include <pthread.h>

namespace octopair::cli {

Interrupt::Interrupt() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    // A shell starts what runs behind its back with SIGINT ignored, and an ignored signal might not be waited for.
    std::signal(SIGINT, SIG_DFL);
    waiter_ = std::thread([this] { wait(); });
    // A thread that starts allocates, and a child forked meanwhile finds a sanitizer's allocator locked for good.
    waits_.wait();
}

Interrupt::~Interrupt() {
    finished_ = true;
    pthread_kill(waiter_.native_handle(), SIGINT);  // one of those it waits for
    waiter_.join();
}

void Interrupt::wait() {
    waits_.count_down();
    int signal = 0;
    while (sigwait(&signals_, &signal) != 0) {
    }
    if (finished_) return;
    stop_.request_stop();
    while (sigwait(&signals_, &signal) != 0) {
    }
    if (finished_) return;
    std::signal(signal, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
    std::raise(signal);
}

}  // namespace octopair::cli
