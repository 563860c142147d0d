// ProgressLine: a progress bar on standard error. It is drawn only on a terminal, and at most ten times per second for
// each activity.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace octopair::cli {

/// Thread safety: only one thread may use it at a time.
class ProgressLine {
public:
    /// Draws nothing if not `wanted`.
    explicit ProgressLine(bool wanted);
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    ~ProgressLine() { clear(); }

    /// Draws the bar. `done` is from 0 to 1.
    void show(std::string_view activity, double done);
    /// Erases the bar, so that other text can be printed.
    void clear();

private:
    bool terminal_;
    bool shown_ = false;
    std::string activity_;
    std::chrono::steady_clock::time_point last_ = {};
};

}  // namespace octopair::cli
