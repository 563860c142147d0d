#include "io/meshes/text_words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

bool is_list_white(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

/// Returns the value of a word that may have a decimal comma in place of the decimal point; nothing if the word is no number.
std::optional<double> number_with_comma(std::string_view word) {
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos || comma + 1 == word.size() || word.find('.') != std::string_view::npos)
        return number_of_word(word);
    std::string with_point(word);
    with_point[comma] = '.';
    return number_of_word(with_point);
}

template <typename Number>
NumberList read_list(std::string_view text, std::string_view separators, const Number& number_of) {
    NumberList list;
    for (auto word = take_list_word(text, separators); !word.empty(); word = take_list_word(text, separators)) {
        const std::optional<double> number = number_of(word);
        if (!number) {
            list.wrong = word;
            return list;
        }
        list.numbers.push_back(*number);
    }
    return list;
}

constexpr std::string_view token_white = " \t\r\n\f\v";

}  // namespace

std::string_view take_list_word(std::string_view& text, std::string_view separators) {
    const auto separates = [&](char c) { return is_list_white(c) || separators.find(c) != std::string_view::npos; };
    const auto begin = std::find_if_not(text.begin(), text.end(), separates);
    const auto end = std::find_if(begin, text.end(), separates);
    const std::string_view word = text.substr(std::size_t(begin - text.begin()), std::size_t(end - begin));
    text.remove_prefix(std::size_t(end - text.begin()));
    return word;
}

std::optional<double> number_of_word(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc()) return number;
    return std::strtod(std::string(word).c_str(), nullptr);  // beyond float64: 0 or infinity
}

NumberList numbers_of(std::string_view text, std::string_view separators) {
    return read_list(text, separators, &number_of_word);
}

NumberList numbers_with_commas_of(std::string_view text) { return read_list(text, {}, &number_with_comma); }

std::string list_text(const std::vector<double>& numbers) {
    std::string text;
    for (const double number : numbers) {
        if (!text.empty()) text += ' ';
        fmt::format_to(std::back_inserter(text), "{}", number);
    }
    return text;
}

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
