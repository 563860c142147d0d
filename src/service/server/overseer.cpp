#include "service/server/overseer.hpp"

#include <utility>

namespace octopair::service {

Overseer::Overseer() : thread_([this] { look_around(); }) {}

Overseer::~Overseer() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void Overseer::watch(const std::shared_ptr<Overseen>& overseen) {
    const std::lock_guard lock(mutex_);
    overseen_.push_back(overseen);
}

void Overseer::look_around() {
    constexpr std::chrono::milliseconds apart(100);
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, apart, [&] { return ending_; })) {
        std::erase_if(overseen_, [](const auto& known) {
            const auto one = known.lock();
            return !one || one->is_over();
        });
        const auto looked_at = overseen_;
        lock.unlock();
        const auto now = std::chrono::steady_clock::now();
        for (const auto& weak : looked_at) {
            if (const auto one = weak.lock()) one->look(now);
        }
        lock.lock();
    }
}

}  // namespace octopair::service
