#include "io/files/failure.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "octopair/error.hpp"

namespace octopair::io {

void refuse(std::string_view file, std::string_view what) {
    throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file, what));
}

std::string number_text(float number) { return std::isnan(number) ? "nan" : fmt::format("{}", number); }
std::string number_text(double number) { return std::isnan(number) ? "nan" : fmt::format("{}", number); }

std::string shown(std::string_view part) {
    std::string text(part.substr(0, 40));
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text;
}

void cancel() { throw Error(ErrorCode::cancelled, "interrupted"); }

}  // namespace octopair::io
