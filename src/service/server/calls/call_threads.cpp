#include "service/server/calls/call_threads.hpp"

#include <utility>

namespace octopair::service {

void CallThreads::start(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    running_.remove_if([](const Running& running) { return running.ended.load(); });
    Running& running = running_.emplace_back();
    try {
        running.thread = std::jthread([&running, work = std::move(work)]() mutable {
            work();
            work = nullptr;  // frees what `work` captured before the thread counts as ended
            running.ended = true;
        });
    } catch (...) {
        running_.pop_back();
        throw;
    }
}

}  // namespace octopair::service
