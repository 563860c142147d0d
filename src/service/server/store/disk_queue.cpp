#include "service/server/store/disk_queue.hpp"

#include <utility>

namespace octopair::service {

DiskQueue::~DiskQueue() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void DiskQueue::add(Errand errand) {
    const std::lock_guard lock(mutex_);
    disk_queue_.push_back(std::move(errand));
    changed_.notify_one();
}

void DiskQueue::run() {
    for (;;) {
        Errand errand;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return ending_ || !disk_queue_.empty(); });
            if (disk_queue_.empty()) return;
            errand = std::move(disk_queue_.front());
            disk_queue_.pop_front();
        }
        errand();
    }
}

}  // namespace octopair::service
