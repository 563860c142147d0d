// TextTokens: the words of a text with structures in braces, such as DirectX and OpenGEX.
#pragma once

#include <string>
#include <string_view>

namespace octopair::io {

struct TextToken {
    std::string_view text;   ///< a name, number or string, or a mark; empty at the end
    std::size_t line = 0;    ///< from 1
    std::size_t offset = 0;  ///< of its first byte in the file
};

class TextTokens {
public:
    /// `marks`: characters that are tokens of their own. `comment`: a character that begins a comment, besides // and /*.
    /// Requires: `text` and `marks` outlive this object. `path` is for messages.
    TextTokens(std::string path, std::string_view text, std::string_view marks, char comment = '\0')
        : path_(std::move(path)), text_(text), marks_(marks), comment_(comment) {}

    TextToken next();
    /// Returns the next token, which stays.
    TextToken peek();
    /// Returns the next number. Semicolons and commas before it are skipped.
    /// Throws: Error{bad_input} with the line if another token follows.
    double number();
    /// Returns the next number. Throws: Error{bad_input} with the line if it is no whole number >= 0.
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
