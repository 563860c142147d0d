#include "service/server/store/errands.hpp"

#include <utility>

namespace octopair::service {

Errands::~Errands() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    thread_.join();
}

void Errands::add(Errand errand) {
    const std::lock_guard lock(mutex_);
    errands_.push_back(std::move(errand));
    changed_.notify_one();
}

void Errands::run() {
    for (;;) {
        Errand errand;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return ending_ || !errands_.empty(); });
            if (errands_.empty()) return;
            errand = std::move(errands_.front());
            errands_.pop_front();
        }
        errand();
    }
}

}  // namespace octopair::service
