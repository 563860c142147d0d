#include "engine/progress.hpp"

#include <algorithm>

namespace octopair {

void Progress::stage(double end, std::uint64_t work) {
    if (!sink_) return;
    const std::lock_guard lock(mutex_);
    begin_ = end_;
    end_ = end;
    work_ = std::max<std::uint64_t>(1, work);
    done_ = 0;
    tell(begin_);
}

void Progress::add(std::uint64_t work) {
    if (!sink_) return;
    const std::lock_guard lock(mutex_);
    done_ += work;
    tell(begin_ + (end_ - begin_) * std::min(1.0, double(done_) / double(work_)));
}

void Progress::finish() {
    if (!sink_) return;
    const std::lock_guard lock(mutex_);
    told_ = std::min(told_, 0.9);
    tell(1.0);
}

/// With the lock held, so that the sink is called by one thread at a time.
void Progress::tell(double fraction) {
    if (told_ >= 0 && fraction < told_ + 0.01) return;
    told_ = fraction;
    sink_(fraction);
}

}  // namespace octopair
