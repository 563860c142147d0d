#include "io/meshes/plain/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view without_space_before(std::string_view text) {
    const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
    return text.substr(std::size_t(begin - text.begin()));
}

}  // namespace

bool TextLines::next() {
    constexpr std::uint64_t lines_between_checks = 4096;
    while (next_ < file_.bytes.size()) {
        if (++number_ % lines_between_checks == 0 && file_.stop.stop_requested()) cancel();
        const std::size_t end = std::min(file_.bytes.find('\n', next_), file_.bytes.size());
        line_ = file_.bytes.substr(next_, end - next_);
        next_ = std::min(end + 1, file_.bytes.size());
        if (comment_ != 0) line_ = line_.substr(0, line_.find(comment_));
        line_ = without_space_before(line_);
        if (!line_.empty()) return true;
    }
    return false;
}

void TextLines::need(std::string_view what) {
    if (!next()) refuse(file_.path, fmt::format("ends where {} should follow", what));
}

std::string_view TextLines::word() {
    line_ = without_space_before(line_);
    const auto end = std::find_if(line_.begin(), line_.end(), is_space);
    const std::string_view word = line_.substr(0, std::size_t(end - line_.begin()));
    line_.remove_prefix(word.size());
    return word;
}

std::string_view TextLines::rest() {
    line_ = without_space_before(line_);
    while (!line_.empty() && is_space(line_.back())) line_.remove_suffix(1);
    return line_;
}

double TextLines::number(std::string_view what) {
    std::string_view text = word();
    if (text.empty()) refuse_line(fmt::format("the line ends where {} should follow", what));
    const std::string_view given = text;
    if (text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = end == text.data() + text.size() && !text.empty();
    if (whole && error == std::errc::result_out_of_range) {
        value = std::strtod(std::string(text).c_str(), nullptr);  // 0, the least numbers, or infinity
    } else if (!whole || error != std::errc()) {
        refuse_line(fmt::format("{} is '{}', not a number", what, shown(given)));
    }
    if (!std::isfinite(value)) refuse_line(fmt::format("{} is {}, not a finite number", what, shown(given)));
    return value;
}

std::uint64_t TextLines::integer(std::string_view what, std::uint64_t most) {
    const std::string_view text = word();
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size() ||
        (error != std::errc() && error != std::errc::result_out_of_range)) {
        refuse_line(fmt::format("{} is '{}', not a number without sign", what, shown(text)));
    }
    if (error != std::errc() || value > most) {
        refuse_line(fmt::format("{} is {}; at most {} is possible", what, shown(text), most));
    }
    return value;
}

void TextLines::refuse_line(std::string_view why) const {
    refuse(file_.path, fmt::format("line {}: {}", number_, why));
}

}  // namespace octopair::io
