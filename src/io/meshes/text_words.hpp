// Words and numbers in texts of mesh files: lists of numbers, and the tokens of a text with structures in braces (TextTokens), such as
// DirectX and OpenGEX.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::io {

/// Removes and returns the next word of a text. Words are separated by white space and the characters of `separators`. Empty: no word is left.
std::string_view take_list_word(std::string_view& text, std::string_view separators = {});

/// Returns the value of a whole word as a number, or nothing if the word is no number. A sign `+` is allowed.
std::optional<double> number_of_word(std::string_view word);

/// A list of numbers. If a word of the text is no number, the list also has this word.
struct NumberList {
    std::vector<double> numbers;
    std::string_view wrong;  ///< empty: all words are numbers
};

NumberList numbers_of(std::string_view text, std::string_view separators = {});

/// Like numbers_of(), but a number may have a comma as decimal point. Requires: white space separates the numbers.
NumberList numbers_with_commas_of(std::string_view text);

/// Returns a text with these numbers, separated by spaces.
std::string list_text(const std::vector<double>& numbers);

struct TextToken {
    std::string_view text;   ///< a name, number or string, or a mark; empty at the end
    std::size_t line = 0;    ///< from 1
    std::size_t offset = 0;  ///< offset of its first byte in the file
};

class TextTokens {
public:
    /// `marks`: characters that are tokens of their own. `comment`: a character that begins a comment, besides // and /*.
    /// Requires: `text` and `marks` outlive this object. `path` is for messages.
    TextTokens(std::string path, std::string_view text, std::string_view marks, char comment = '\0')
        : path_(std::move(path)), text_(text), marks_(marks), comment_(comment) {}

    TextToken next();
    /// Returns the next token without removing it.
    TextToken peek();
    /// Returns the next number. Semicolons and commas before it are skipped.
    /// Throws: Error{bad_input} with the line if another token follows.
    double number();
    /// Returns the next number. Throws: Error{bad_input} with the line if the number is no whole number >= 0.
    std::size_t count();

    /// Throws: Error{bad_input} "FILE: line N: WHAT".
    [[noreturn]] void refuse(std::size_t line, std::string_view what) const;

private:
    void skip_to_token();

    std::string path_;
    std::string_view text_, marks_;
    char comment_;
    std::size_t at_ = 0, line_ = 1;
};

}  // namespace octopair::io
