// LineSplitter: the lines of a text, for all readers of text.
//
// - A UTF-8 byte order mark at the begin of the text is left out.
// - A line ends with LF, CR LF, or CR. If the first line ends with CR alone, each CR and each LF ends a line of its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace octopair::io {

class LineSplitter {
public:
    /// Borrows the text.
    explicit LineSplitter(std::string_view text);

    /// Goes to the next line. Returns false at the end of the text.
    bool next() {
        if (next_ >= text_.size()) return false;
        ++number_;
        // The search runs once per LF, not once per line, so that a text without LF is searched only once.
        if (line_feed_ < next_) line_feed_ = std::min(text_.find('\n', next_), text_.size());
        if (carriage_return_ < line_feed_ && find_carriage_return()) {
            end_line(carriage_return_);
        } else {
            line_ = {text_.data() + next_, line_feed_ - next_};
            next_ = line_feed_ + 1;
        }
        return true;
    }

    /// Returns the line without its end.
    std::string_view line() const { return line_; }
    /// Returns the number of the line, from 1 on.
    std::uint64_t number() const { return number_; }
    /// Returns the offset of the byte after the end of the line.
    std::size_t offset() const { return std::min(next_, text_.size()); }

private:
    /// Returns whether the line ends with a CR before the next LF. Sets `carriage_return_` to the place of the next CR.
    bool find_carriage_return();
    void end_line(std::size_t carriage_return);

    std::string_view text_, line_;
    std::uint64_t number_ = 0;
    std::size_t next_ = 0;             // begin of the next line
    std::size_t line_feed_ = 0;        // place of the first LF from next_ on, or the size of the text
    std::size_t carriage_return_ = 0;  // no CR is between next_ and this place, which may have one
    bool cr_alone_ = false;            // true if the first line ends with CR alone
};

/// Returns an upper bound on the number of lines.
std::uint64_t most_lines(std::string_view text);

}  // namespace octopair::io
