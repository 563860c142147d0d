// Progress: combines the work that many threads do in several stages into one fraction that never decreases.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>

#include "octopair/engine.hpp"

namespace octopair {

/// Fraction of the time of a pass in ascending order that its scan takes, if objects have many pairs. Sorting takes the rest.
inline constexpr double ascending_scan_part = 0.6;

class Progress {
public:
    /// Requires: `sink` outlives this object. `sink` may be empty.
    explicit Progress(const ProgressSink& sink) : sink_(sink) {}

    /// Begins a stage of `work` units, during which the fraction grows linearly to `end`.
    void stage(double end, std::uint64_t work) {
        if (!sink_) return;
        const std::lock_guard lock(mutex_);
        begin_ = end_;
        end_ = end;
        work_ = std::max<std::uint64_t>(1, work);
        done_ = 0;
        report(begin_);
    }
    /// Returns the fraction at the end of the stage.
    double end() const { return end_; }
    /// Counts `work` units as done, and reports to the sink about every hundredth. Thread safety: any thread.
    void add(std::uint64_t work) {
        if (!sink_) return;
        const std::lock_guard lock(mutex_);
        done_ += work;
        report(begin_ + (end_ - begin_) * std::min(1.0, double(done_) / double(work_)));
    }
    /// Reports 1 to the sink.
    void finish() {
        if (!sink_) return;
        const std::lock_guard lock(mutex_);
        reported_ = std::min(reported_, 0.9);
        report(1.0);
    }

private:
    /// Requires: the lock is held, so that only one thread at a time calls the sink.
    void report(double fraction) {
        if (reported_ >= 0 && fraction < reported_ + 0.01) return;
        reported_ = fraction;
        sink_(fraction);
    }

    const ProgressSink& sink_;
    std::mutex mutex_;
    double begin_ = 0;
    double end_ = 0;
    double reported_ = -1;
    std::uint64_t work_ = 1;
    std::uint64_t done_ = 0;
};

}  // namespace octopair
