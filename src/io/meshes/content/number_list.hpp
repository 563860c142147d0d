// Lists of numbers in texts of mesh files.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace octopair::io {

/// Removes and returns the next word of a text. Words are separated by white space and the characters of `separators`. Empty: no word is left.
std::string_view take_list_word(std::string_view& text, std::string_view separators = {});

/// Returns the value of a whole word as a number, or nothing if it is none. A sign `+` is allowed.
std::optional<double> number_of_word(std::string_view word);

/// A list of numbers, or the first word that is no number.
struct NumberList {
    std::vector<double> numbers;
    std::string_view wrong;  ///< empty: all words are numbers
};

NumberList numbers_of(std::string_view text, std::string_view separators = {});

/// As numbers_of(), but a number may have a comma as decimal point. Requires: white space separates the numbers.
NumberList numbers_with_commas_of(std::string_view text);

}  // namespace octopair::io
