// One line on standard error that says how far the work is; only on a terminal, redrawn ten times a second at most.
#pragma once

#include <chrono>
#include <string_view>

namespace octopair::cli {

/// Used by one thread at a time.
class ProgressLine {
public:
    explicit ProgressLine(bool wanted);
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;
    ~ProgressLine() { clear(); }

    /// `done` is from 0 to 1.
    void show(std::string_view activity, double done);
    /// Leaves the terminal as it was, for what else is printed.
    void clear();

private:
    bool terminal_;
    bool shown_ = false;
    std::chrono::steady_clock::time_point last_ = {};
};

}  // namespace octopair::cli
