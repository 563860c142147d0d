#include "cli/command/option_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "cli/command/suggestion.hpp"
#include "octopair/error.hpp"
#include "octopair/limits.hpp"

namespace octopair::cli {

namespace {

/// Returns a value for messages, with ? for control characters.
std::string shown_value(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '?');
    return text;
}

template <typename Number>
bool parse_whole_text(const std::string& text, Number& number) {
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && stop == end;
}

}  // namespace

void check_value(std::string_view option, const std::vector<std::string_view>& valid, const std::string& value) {
    if (std::find(valid.begin(), valid.end(), value) != valid.end()) return;
    const std::string suggestion = did_you_mean(value, valid);
    throw Error(ErrorCode::usage,
                fmt::format("{}: '{}' is not a valid value{} {}: {}", option, shown_value(value),
                            suggestion.empty() ? ";" : suggestion, suggestion.empty() ? "valid values" : "Valid values",
                            fmt::join(valid, ", ")));
}

std::uint64_t parse_count(std::string_view option, const std::string& text, std::uint64_t most) {
    std::uint64_t number = 0;
    if (parse_whole_text(text, number) && number <= most) return number;
    const std::string_view digits = std::string_view(text).substr(text.starts_with('-') ? 1 : 0);
    const bool is_number = !digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos;
    throw Error(ErrorCode::usage, is_number ? fmt::format("{}: {} is not in the range 0 to {}", option, text, most)
                                            : fmt::format("{}: '{}' is not a whole number from 0 to {}", option,
                                                          shown_value(text), most));
}

unsigned parse_threads(const std::string& text) { return unsigned(parse_count("--threads", text, max_threads)); }

std::uint64_t parse_bytes(std::string_view option, const std::string& text) {
    constexpr std::string_view suffixes = "KMGT";
    const std::size_t suffix = text.empty() ? std::string_view::npos : suffixes.find(text.back());
    const unsigned shift = suffix == std::string_view::npos ? 0 : 10 * (unsigned(suffix) + 1);
    std::uint64_t number = 0;
    const std::string digits = text.substr(0, text.size() - (shift > 0 ? 1 : 0));
    if (parse_whole_text(digits, number) && number <= std::numeric_limits<std::uint64_t>::max() >> shift) {
        return number << shift;
    }
    throw Error(ErrorCode::usage, fmt::format("{}: '{}' is not a number of bytes, for example 65536, 64K or 4G", option,
                                              shown_value(text)));
}

double parse_length(std::string_view option, const std::string& text) {
    double number = 0;
    if (parse_whole_text(text, number) && std::isfinite(number) && number >= 0) return number;
    throw Error(ErrorCode::usage, fmt::format("{}: '{}' is not a finite number >= 0", option, shown_value(text)));
}

std::string grouped(std::uint64_t number) {
    const std::string digits = std::to_string(number);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
        text += digits[i];
    }
    return text;
}

namespace {

namespace fs = std::filesystem;

/// Returns whether two paths are one regular file, or would be one after it is written. Errors are ignored: readers and writers
/// report invalid paths.
bool are_same_file(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (a.empty() || b.empty() || a == "-" || b == "-") return false;
    if (fs::exists(a, error) && fs::exists(b, error))
        return fs::equivalent(a, b, error) && fs::is_regular_file(a, error);
    return fs::weakly_canonical(fs::absolute(a, error), error) == fs::weakly_canonical(fs::absolute(b, error), error);
}

}  // namespace

void check_outputs(const std::vector<FileOption>& inputs, const std::vector<FileOption>& outputs) {
    for (auto output = outputs.begin(); output != outputs.end(); ++output) {
        for (const FileOption& input : inputs) {
            if (!are_same_file(output->path, input.path)) continue;
            const std::string what = input.option.empty() ? "an input" : fmt::format("the file of {}", input.option);
            throw Error(ErrorCode::usage,
                        fmt::format("{}: {} is also {}, which would be replaced", output->option, output->path, what));
        }
        for (auto earlier = outputs.begin(); earlier != output; ++earlier) {
            if (!are_same_file(output->path, earlier->path)) continue;
            throw Error(ErrorCode::usage,
                        fmt::format("{}: {} is also the file of {}", output->option, output->path, earlier->option));
        }
    }
}

}  // namespace octopair::cli
