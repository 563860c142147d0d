// TextLines: the lines of a text, their words and numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/meshes/plain/plain_mesh.hpp"

namespace octopair::io {

class TextLines {
public:
    /// `comment`: a character that begins a comment to the end of the line; 0: there are none. Borrows `file`.
    explicit TextLines(const FileContent& file, char comment = 0) : file_(file), comment_(comment) {}

    /// Goes to the next line that has a word. Returns false at the end of the text. Throws: Error{cancelled}.
    bool next();
    /// Like next(), but the end of the text is an error. `what`: what is expected, for the message.
    void need(std::string_view what);

    /// Returns the next word of the line; empty at its end.
    std::string_view word();
    /// Returns the rest of the line, without white space around it.
    std::string_view rest();
    /// Returns the next word as a number. Throws: Error{bad_input} if it is none, or not finite.
    double number(std::string_view what);
    /// Returns the next word as an integer of at most `most`.
    std::uint64_t integer(std::string_view what, std::uint64_t most);

    /// Throws: Error{bad_input} with the number of the line.
    [[noreturn]] void refuse_line(std::string_view why) const;
    /// Offset of the byte after the line.
    std::size_t offset() const { return next_; }

private:
    /// Like number(), for words that need a closer look: wrong ones, and those beyond the range of float64.
    double unusual_number(std::string_view what);
    [[noreturn]] void refuse_integer(std::string_view what, std::uint64_t most);

    const FileContent& file_;
    char comment_;
    std::size_t next_ = 0;  // begin of the next line
    std::uint64_t number_ = 0;
    std::string_view line_;
};

}  // namespace octopair::io
