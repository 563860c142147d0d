// Progress: combines the work that many threads do in several stages into one fraction that never decreases.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "base/private_export.hpp"
#include "octopair/engine.hpp"

namespace octopair {

/// Fraction of the time of a pass in ascending order that its scan takes, if objects have many pairs. Sorting takes the rest.
inline constexpr double ascending_scan_part = 0.6;

class OCTOPAIR_PRIVATE_EXPORT Progress {
public:
    /// Requires: `sink` outlives this object. `sink` may be empty.
    explicit Progress(const ProgressSink& sink) : sink_(sink) {}

    /// Begins a stage of `work` units, during which the fraction grows linearly to `end`.
    void stage(double end, std::uint64_t work);
    /// Returns the fraction at the end of the stage.
    double end() const { return end_; }
    /// Counts `work` units as done, and reports to the sink about every hundredth. Thread safety: any thread.
    void add(std::uint64_t work);
    /// Reports 1 to the sink.
    void finish();

private:
    void report(double fraction);

    const ProgressSink& sink_;
    std::mutex mutex_;
    double begin_ = 0;
    double end_ = 0;
    double reported_ = -1;
    std::uint64_t work_ = 1;
    std::uint64_t done_ = 0;
};

}  // namespace octopair
