// Progress: one rising fraction out of steps that many threads take.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "octopair/engine.hpp"

namespace octopair {

class Progress {
public:
    /// `sink` may be empty, and must outlive this.
    explicit Progress(const ProgressSink& sink) : sink_(sink) {}

    /// From now on `work` steps lead from here to the fraction `end`.
    void stage(double end, std::uint64_t work);
    /// Counts steps as done. From any thread; tells the sink every hundredth or so.
    void add(std::uint64_t work);
    /// Tells the sink 1.
    void finish();

private:
    void tell(double fraction);

    const ProgressSink& sink_;
    std::mutex mutex_;
    double begin_ = 0;
    double end_ = 0;
    double told_ = -1;
    std::uint64_t work_ = 1;
    std::uint64_t done_ = 0;
};

}  // namespace octopair
