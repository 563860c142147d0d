#include "cli/command/progress_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace octopair::cli {

ProgressLine::ProgressLine(bool wanted) : terminal_(wanted && ::isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(std::string_view activity, double done) {
    if (!terminal_) return;
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && activity == activity_ && now - last_ < std::chrono::milliseconds(100)) return;
    constexpr std::size_t width = 40;
    done = std::clamp(done, 0.0, 1.0);
    std::string bar(std::size_t(done * double(width)), '#');
    bar.resize(width, ' ');
    fmt::print(stderr, "\r{} [{}] {:3.0f}%\x1b[K", activity, bar, done * 100);
    std::fflush(stderr);
    shown_ = true;
    activity_ = activity;
    last_ = now;
}

void ProgressLine::clear() {
    if (!shown_) return;
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
    shown_ = false;
}

}  // namespace octopair::cli
