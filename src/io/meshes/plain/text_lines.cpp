#include "io/meshes/plain/text_lines.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

/// Returns whether a character of a line is white space: a space, or one of \t \v \f \r.
bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string_view without_space_before(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    return text;
}

/// Replaces D, with which Fortran begins the exponent of a number (1.5D+03), by E.
void replace_fortran_exponent(std::string& number) {
    const std::size_t at = number.find_first_of("dD");
    if (at == std::string::npos || at == 0) return;
    const char before = number[at - 1];
    if ((before >= '0' && before <= '9') || before == '.') number[at] = 'e';
}

}  // namespace

bool TextLines::next() {
    constexpr std::uint64_t lines_between_checks = 4096;
    while (lines_.next()) {
        number_ = lines_.number();
        line_ = lines_.line();
        if (number_ % lines_between_checks == 0) checkpoint();
        if (comment_ != 0) cut(comment_);
        line_ = without_space_before(line_);
        if (!line_.empty()) return true;
    }
    return false;
}

void TextLines::require_line(std::string_view what) {
    if (next()) return;
    refuse(file_.path, number_ == 0
                           ? fmt::format("has no text, but {} is needed", what)
                           : fmt::format("the file ends after line {}, where {} should follow; copy or save it again",
                                         number_, what));
}

std::uint64_t TextLines::skip_words() {
    std::uint64_t words = 0;
    while (!next_word().empty()) ++words;
    return words;
}

void TextLines::find_distant_word(std::string_view what) {
    line_ = without_space_before(line_);
    if (line_.empty()) require_line(what);
}

void TextLines::join_continued(char mark) {
    if (!line_.ends_with(mark)) return;
    joined_ = line_;
    while (joined_.ends_with(mark)) {
        joined_.back() = ' ';
        if (lines_.next()) joined_ += lines_.line();
    }
    line_ = joined_;
}

std::string_view TextLines::next_word() {
    const std::string_view word = peek();
    line_.remove_prefix(word.size());
    return word;
}

std::string_view TextLines::peek() {
    line_ = without_space_before(line_);
    std::size_t size = 0;
    while (size < line_.size() && !is_space(line_[size])) ++size;
    return line_.substr(0, size);
}

void TextLines::skip(std::size_t characters) { line_.remove_prefix(characters); }

std::string_view TextLines::rest() {
    line_ = without_space_before(line_);
    while (!line_.empty() && is_space(line_.back())) line_.remove_suffix(1);
    return line_;
}

double TextLines::number(std::string_view what) {
    line_ = without_space_before(line_);
    if (line_.empty()) refuse_line(fmt::format("the line ends where {} should follow", what));
    const char* const end = line_.data() + line_.size();
    const bool plus = line_.front() == '+';
    double value = 0;
    const auto [after, error] = std::from_chars(line_.data() + (plus ? 1 : 0), end, value);
    const bool is_number = error == std::errc() && (after == end || is_space(*after)) && std::isfinite(value);
    if (!is_number || (plus && line_.starts_with("+-"))) return unusual_number(what);
    line_.remove_prefix(std::size_t(after - line_.data()));
    return value;
}

double TextLines::unusual_number(std::string_view what) {
    const std::string_view given = word();
    std::string text(given);
    if (text.front() == '+' && !text.starts_with("+-")) text.erase(0, 1);
    replace_fortran_exponent(text);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole = end == text.data() + text.size() && !text.empty();
    if (whole && error == std::errc::result_out_of_range) {
        value = std::strtod(text.c_str(), nullptr);  // the result is 0, a subnormal number or infinity
    } else if (!whole || error != std::errc()) {
        const bool comma = given.find(',') != std::string_view::npos;
        refuse_line(fmt::format("{} is '{}', not a number{}", what, shown(given),
                                comma ? "; write numbers with a point and separate them with spaces" : ""));
    }
    if (!std::isfinite(value)) refuse_line(fmt::format("{} is {}, not a finite number", what, shown(given)));
    return value;
}

std::uint64_t TextLines::integer(std::string_view what, std::uint64_t most) {
    line_ = without_space_before(line_);
    constexpr std::size_t safe_digits = 19;  // they fit into 64 bits
    std::uint64_t value = 0;
    std::size_t length = 0;
    while (length < std::min(line_.size(), safe_digits) && line_[length] >= '0' && line_[length] <= '9')
        value = value * 10 + std::uint64_t(line_[length++] - '0');
    const bool is_integer = length > 0 && (length == line_.size() || is_space(line_[length])) && value <= most;
    if (!is_integer) refuse_integer(what, most);
    line_.remove_prefix(length);
    return value;
}

void TextLines::refuse_integer(std::string_view what, std::uint64_t most) {
    const std::string_view text = word();
    if (text.empty()) refuse_line(fmt::format("the line ends where {} should follow", what));
    if (text.find_first_not_of("0123456789") != std::string_view::npos)
        refuse_line(fmt::format("{} is '{}', not a number without sign", what, shown(text)));
    refuse_line(fmt::format("{} is {}, but at most {} is possible; save the file again", what, shown(text), most));
}

void TextLines::refuse_line(std::string_view why) const {
    refuse(file_.path, fmt::format("line {}: {}", number_, why));
}

}  // namespace octopair::io
