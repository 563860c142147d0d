// TextLines: reads the lines of a text, and the words and numbers of each line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/files/letter_case.hpp"
#include "io/files/line_splitter.hpp"
#include "io/meshes/plain/plain_mesh.hpp"

namespace octopair::io {

class TextLines {
public:
    /// `comment`: a character that begins a comment to the end of the line; 0: there are none. Borrows `file`.
    explicit TextLines(const FileContent& file, char comment = 0)
        : file_(file), lines_(file.bytes), comment_(comment) {}
    TextLines(const TextLines&) = delete;
    TextLines& operator=(const TextLines&) = delete;

    /// Goes to the next line that has a word. Returns false at the end of the text. Throws: Error{cancelled}.
    bool next();
    /// Like next(), but throws at the end of the text. `what`: the expected content, for the message.
    void require_line(std::string_view what);
    /// Joins the line with the lines after it, as long as it ends with `mark`, which becomes a space.
    void join_continued(char mark);

    /// Returns whether the next character of the line is `c`.
    bool begins_with(char c) const { return line_.starts_with(c); }
    /// Returns the next word of the line; empty at its end.
    std::string_view word() { return line_.empty() ? std::string_view() : next_word(); }
    /// Returns the next word like word(), but does not move past the word.
    std::string_view peek();
    /// Skips `characters` characters of the next word. Requires: the word has at least so many.
    void skip(std::size_t characters);
    bool contains(char c) const { return line_.find(c) != std::string_view::npos; }
    /// Returns the rest of the line, without white space around it.
    std::string_view rest();
    /// Skips the rest of the line. Returns its number of words.
    std::uint64_t skip_line() { return line_.empty() ? 0 : skip_words(); }
    /// Removes the rest of the line from `comment` on.
    void cut(char comment) { line_ = line_.substr(0, line_.find(comment)); }
    /// Goes to the next word of the text, on this line or a later line. Throws at the end of the text. `what`: the expected content.
    void find_word(std::string_view what) {
        const bool is_next = line_.size() > 1 && line_[0] == ' ' && line_[1] > ' ';
        if (!is_next) find_distant_word(what);
    }
    /// Returns the next word as a number. Throws: Error{bad_input} if the word is no number, or not finite.
    double number(std::string_view what);
    /// Returns the next word as an integer. Throws: Error{bad_input} if the word is none, or greater than `most`.
    std::uint64_t integer(std::string_view what, std::uint64_t most);

    /// Calls FileContent::checkpoint(). Readers of long lines call this from time to time; next() does so, too.
    void checkpoint() const { file_.checkpoint(lines_.offset() - line_.size()); }
    /// Throws: Error{bad_input} with the number of the line.
    [[noreturn]] void refuse_line(std::string_view why) const;
    /// Number of the line; of several joined lines, the number of the first line.
    std::uint64_t line_number() const { return number_; }
    /// Offset of the byte after the line.
    std::size_t offset() const { return lines_.offset(); }

private:
    std::string_view next_word();
    std::uint64_t skip_words();
    void find_distant_word(std::string_view what);
    /// Like number(), for the rare words that are no number, or beyond the range of float64.
    double unusual_number(std::string_view what);
    [[noreturn]] void refuse_integer(std::string_view what, std::uint64_t most);

    const FileContent& file_;
    LineSplitter lines_;
    char comment_;
    std::uint64_t number_ = 0;
    std::string_view line_;
    std::string joined_;  // text of the joined lines
};

}  // namespace octopair::io
