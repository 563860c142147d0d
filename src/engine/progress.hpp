// Progress: combines the work that many threads do in several stages into one fraction that never decreases.
#pragma once

#include <algorithm>
#include <atomic>
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

    /// Begins a stage of `work` units, during which the fraction grows linearly to `end`. Requires: no thread calls add().
    void stage(double end, std::uint64_t work) {
        begin_ = end_;
        end_ = end;
        work_ = std::max<std::uint64_t>(1, work);
        done_ = 0;
        if (!sink_) return;
        const std::lock_guard lock(mutex_);
        report(begin_);
    }
    /// Corrects the amount of work of the stage. Requires: no thread calls add().
    void set_work(std::uint64_t work) { work_ = std::max<std::uint64_t>(1, work); }
    /// Ends the stage before its work is done. The next stage begins at the current fraction. Requires: no thread calls add().
    void abandon_stage() { end_ = begin_ + (end_ - begin_) * of_stage(); }
    /// Returns the fraction at the end of the stage.
    double end() const { return end_; }
    /// Returns how much of the work of the stage is done, 0 to 1. Thread safety: any thread.
    double of_stage() const { return std::min(1.0, double(done_.load()) / double(work_)); }
    /// Counts `work` units as done, and reports to the sink about every hundredth. Thread safety: any thread.
    void add(std::uint64_t work) {
        done_ += work;
        if (!sink_) return;
        const std::lock_guard lock(mutex_);
        report(begin_ + (end_ - begin_) * of_stage());
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
    std::atomic<std::uint64_t> done_ = 0;
};

}  // namespace octopair
