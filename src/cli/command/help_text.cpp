#include "cli/command/help_text.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace octopair::cli {

namespace {

/// Appends lines of at most `width` characters to a text.
class Lines {
public:
    explicit Lines(std::size_t width) : width_(width) {}

    /// Appends words to the current line. Continues on lines that are indented by `indent` spaces.
    void add_words(std::string_view words, std::size_t indent) {
        while (!words.empty()) {
            const std::size_t end = std::min(words.find(' '), words.size());
            add_word(words.substr(0, end), indent);
            words.remove_prefix(std::min(end + 1, words.size()));
        }
    }
    /// Moves to a column of the current line, or of the next line if the current one would not end two spaces before the column.
    void move_to(std::size_t column) {
        if (used_ > 0 && used_ + 2 > column) end_line();
        text_.append(column - used_, ' ');
        used_ = column;
        is_at_word_ = true;
    }
    void end_line() {
        text_ += '\n';
        used_ = 0;
        is_at_word_ = true;
    }
    void add_line(std::string_view line) {
        text_ += line;
        end_line();
    }

    std::string take() { return std::move(text_); }

private:
    void add_word(std::string_view word, std::size_t indent) {
        if (!is_at_word_ && used_ + 1 + word.size() > width_) {
            end_line();
            move_to(indent);
        }
        if (!is_at_word_) text_ += ' ', ++used_;
        text_ += word;
        used_ += word.size();
        is_at_word_ = false;
    }

    std::size_t width_, used_ = 0;
    bool is_at_word_ = true;  // true: the next word needs no space before it
    std::string text_;
};

/// Returns the column of the descriptions: after the longest name that leaves two thirds of the width.
std::size_t description_column(const Help& help, std::size_t width) {
    const std::size_t most = width * 3 / 10;
    std::size_t longest = 0;
    for (const HelpSection& section : help.sections) {
        for (const HelpEntry& entry : section.entries) {
            if (entry.name.size() <= most) longest = std::max(longest, entry.name.size());
        }
    }
    return longest + 4;
}

}  // namespace

std::string help_text(const Help& help, std::size_t width) {
    const std::string usage = "Usage: " + help.command;
    const std::size_t column = description_column(help, width);
    Lines lines(width);
    lines.add_words(help.description, 0);
    lines.end_line();
    lines.end_line();
    lines.add_words(usage, 0);
    lines.add_words(help.usage, std::min(usage.size() + 1, width / 2));
    lines.end_line();
    for (const auto& [title, entries] : help.sections) {
        lines.end_line();
        lines.add_line(title + ':');
        for (const HelpEntry& entry : entries) {
            lines.move_to(2);
            lines.add_words(entry.name, 4);
            lines.move_to(column);
            lines.add_words(entry.text, column);
            lines.end_line();
        }
    }
    if (!help.examples.empty()) {
        lines.end_line();
        lines.add_line("Examples:");
        for (const std::string& example : help.examples) lines.add_line("  " + example);
    }
    if (!help.more.empty()) {
        lines.end_line();
        lines.add_words(help.more, 0);
        lines.end_line();
    }
    return lines.take();
}

std::size_t help_width() {
    constexpr std::size_t usual = 80, least = 40, most = 100;
    std::size_t width = 0;
    winsize terminal{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &terminal) == 0) width = terminal.ws_col;
    if (const char* const columns = std::getenv("COLUMNS"); width == 0 && columns != nullptr) {
        const std::string_view text = columns;
        (void)std::from_chars(text.data(), text.data() + text.size(), width);
    }
    return width == 0 ? usual : std::clamp(width, least, most);
}

}  // namespace octopair::cli
