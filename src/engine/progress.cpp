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
    report(begin_);
}

void Progress::add(std::uint64_t work) {
    if (!sink_) return;
    const std::lock_guard lock(mutex_);
    done_ += work;
    report(begin_ + (end_ - begin_) * std::min(1.0, double(done_) / double(work_)));
}

void Progress::finish() {
    if (!sink_) return;
    const std::lock_guard lock(mutex_);
    reported_ = std::min(reported_, 0.9);
    report(1.0);
}

/// Requires: the lock is held, so that only one thread at a time calls the sink.
void Progress::report(double fraction) {
    if (reported_ >= 0 && fraction < reported_ + 0.01) return;
    reported_ = fraction;
    sink_(fraction);
}

}  // namespace octopair
