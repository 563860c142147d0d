#include "io/meshes/content/text_tokens.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/content/number_list.hpp"

namespace octopair::io {

namespace {

constexpr std::string_view token_white = " \t\r\n\f\v";

}  // namespace

void TextTokens::skip_to_token() {
    while (at_ < text_.size()) {
        if (text_[at_] == '\n') ++line_;
        if ((comment_ != '\0' && text_[at_] == comment_) || text_.substr(at_, 2) == "//") {
            at_ = std::min(text_.find('\n', at_), text_.size());
        } else if (text_.substr(at_, 2) == "/*") {
            const std::size_t end = std::min(text_.find("*/", at_ + 2), text_.size() - 2) + 2;
            line_ +=
                std::size_t(std::count(text_.begin() + std::ptrdiff_t(at_), text_.begin() + std::ptrdiff_t(end), '\n'));
            at_ = end;
        } else if (token_white.find(text_[at_]) != std::string_view::npos || text_[at_] == '\0') {
            ++at_;
        } else {
            return;
        }
    }
}

TextToken TextTokens::next() {
    skip_to_token();
    TextToken token{{}, line_, at_};
    if (at_ == text_.size()) return token;
    std::size_t end = at_ + 1;
    if (text_[at_] == '"') {
        end = std::min(text_.find('"', end), text_.size() - 1) + 1;
    } else if (marks_.find(text_[at_]) == std::string_view::npos) {
        while (end < text_.size() && token_white.find(text_[end]) == std::string_view::npos &&
               marks_.find(text_[end]) == std::string_view::npos)
            ++end;
    }
    token.text = text_.substr(at_, end - at_);
    line_ += std::size_t(std::count(token.text.begin(), token.text.end(), '\n'));
    at_ = end;
    return token;
}

TextToken TextTokens::peek() {
    const std::size_t at = at_, line = line_;
    const TextToken token = next();
    at_ = at;
    line_ = line;
    return token;
}

double TextTokens::number() {
    TextToken token = next();
    while (token.text == ";" || token.text == ",") token = next();
    const auto number = number_of_word(token.text);
    if (!number) refuse(token.line, fmt::format("'{}' is in the place of a number", shown(token.text)));
    return *number;
}

std::size_t TextTokens::count() {
    const TextToken token = peek();
    const double value = number();
    if (!(value >= 0) || value > 1e15 || value != std::floor(value))
        refuse(token.line, fmt::format("{} is in the place of a whole number", number_text(value)));
    return std::size_t(value);
}

void TextTokens::refuse(std::size_t line, std::string_view what) const {
    io::refuse(path_, fmt::format("line {}: {}", line, what));
}

}  // namespace octopair::io
