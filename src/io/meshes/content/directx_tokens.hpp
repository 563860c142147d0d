// DirectxTokens: the words of a DirectX text.
#pragma once

#include <string>
#include <string_view>

namespace octopair::io {

struct DirectxToken {
    std::string_view text;   ///< a name, number or string, or one of { } ; , and empty at the end
    std::size_t line = 0;    ///< from 1
    std::size_t offset = 0;  ///< of its first byte in the file
};

class DirectxTokens {
public:
    /// Requires: `text` outlives this object. `path` is for messages.
    DirectxTokens(std::string path, std::string_view text) : path_(std::move(path)), text_(text) {}

    DirectxToken next();
    /// Returns the next token, which stays.
    DirectxToken peek();
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
    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

}  // namespace octopair::io
