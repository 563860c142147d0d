#include "io/meshes/content/number_list.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

namespace octopair::io {

namespace {

bool is_list_white(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

/// Returns the value of a word that may have a comma in place of the point.
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
    return std::strtod(std::string(word).c_str(), nullptr);  // 0 or infinite: beyond float64
}

NumberList numbers_of(std::string_view text, std::string_view separators) {
    return read_list(text, separators, &number_of_word);
}

NumberList numbers_with_commas_of(std::string_view text) { return read_list(text, {}, &number_with_comma); }

}  // namespace octopair::io
