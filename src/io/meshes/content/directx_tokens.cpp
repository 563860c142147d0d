#include "io/meshes/content/directx_tokens.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/content/number_list.hpp"

namespace octopair::io {

namespace {

constexpr std::string_view directx_white = " \t\r\n\f\v", directx_marks = "{};,";

}  // namespace

void DirectxTokens::skip_to_token() {
    while (at_ < text_.size()) {
        if (text_[at_] == '\n') ++line_;
        if (text_[at_] == '#' || text_.substr(at_, 2) == "//") {
            at_ = std::min(text_.find('\n', at_), text_.size());
        } else if (directx_white.find(text_[at_]) != std::string_view::npos || text_[at_] == '\0') {
            ++at_;
        } else {
            return;
        }
    }
}

DirectxToken DirectxTokens::next() {
    skip_to_token();
    DirectxToken token{{}, line_, at_};
    if (at_ == text_.size()) return token;
    std::size_t end = at_ + 1;
    if (text_[at_] == '"') {
        end = std::min(text_.find('"', end), text_.size() - 1) + 1;
    } else if (directx_marks.find(text_[at_]) == std::string_view::npos) {
        while (end < text_.size() && directx_white.find(text_[end]) == std::string_view::npos &&
               directx_marks.find(text_[end]) == std::string_view::npos)
            ++end;
    }
    token.text = text_.substr(at_, end - at_);
    line_ += std::size_t(std::count(token.text.begin(), token.text.end(), '\n'));
    at_ = end;
    return token;
}

DirectxToken DirectxTokens::peek() {
    const std::size_t at = at_, line = line_;
    const DirectxToken token = next();
    at_ = at;
    line_ = line;
    return token;
}

double DirectxTokens::number() {
    DirectxToken token = next();
    while (token.text == ";" || token.text == ",") token = next();
    const auto number = number_of_word(token.text);
    if (!number) refuse(token.line, fmt::format("'{}' is in the place of a number", shown(token.text)));
    return *number;
}

std::size_t DirectxTokens::count() {
    const DirectxToken token = peek();
    const double value = number();
    if (!(value >= 0) || value > 1e15 || value != std::floor(value))
        refuse(token.line, fmt::format("{} is in the place of a whole number", number_text(value)));
    return std::size_t(value);
}

void DirectxTokens::refuse(std::size_t line, std::string_view what) const {
    io::refuse(path_, fmt::format("line {}: {}", line, what));
}

}  // namespace octopair::io
