// Reads options of a subcommand from a file. A line `NAME = VALUE` sets the option --NAME.
//
// The format is a subset of TOML, except that a word needs no quotes. A value is a word, or a string in quotes without escapes. Each line
// sets an option, is empty, or is a comment after '#'. Any other line is an error. CLI11's own reader is not used: it accepts most
// files with typing errors, and then sets wrong options.
#include <algorithm>
#include <cerrno>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "base/descriptor.hpp"
#include "cli/command/command.hpp"
#include "cli/command/suggestion.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& place, const std::string& why) {
    throw Error(ErrorCode::usage, file + ": " + place + ": " + why);
}

/// Returns the text of a file. Refuses a file that is not text: error messages would print its bytes, which may be secret, or control
/// the terminal.
std::string text_of(const std::string& file) {
    constexpr std::size_t max_bytes = 1 << 20;
    std::ifstream in(file, std::ios::binary);
    if (!in) fail_io(file, "cannot open", errno);
    std::string text(max_bytes + 1, '\0');
    in.read(text.data(), std::streamsize(text.size()));
    if (in.bad()) fail_io(file, "cannot read", errno);
    text.resize(std::size_t(in.gcount()));
    const auto is_control = [](char c) {
        return (c >= 0 && c < ' ' && c != '\n' && c != '\r' && c != '\t') || c == 0x7F;
    };
    if (text.size() > max_bytes || std::any_of(text.begin(), text.end(), is_control))
        throw Error(ErrorCode::bad_input, file + ": not a text file of at most 1 MiB");
    return text;
}

/// A line NAME = VALUE.
struct Entry {
    std::string name, value;
};

/// Thrown for a line with a syntax error.
struct WrongLine {
    const char* why;
};

/// Reads a line from left to right. Its members throw WrongLine.
class LineReader {
public:
    explicit LineReader(std::string_view line) : rest_(line) {
        if (rest_.ends_with('\r')) rest_.remove_suffix(1);
        if (rest_.find('\r') != std::string_view::npos)
            throw WrongLine{"a carriage return must be at the end of a line"};
        skip_blanks();
    }

    /// Returns whether nothing is left but a comment.
    bool ends() const { return rest_.empty() || rest_.front() == '#'; }

    Entry entry() {
        Entry entry;
        entry.name = take(rest_.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"));
        skip_blanks();
        if (entry.name.empty() || !rest_.starts_with('='))
            throw WrongLine{"a line must be NAME = VALUE, or begin with #"};
        rest_.remove_prefix(1);
        skip_blanks();
        const bool in_quotes = rest_.starts_with('"') || rest_.starts_with('\'');
        entry.value = in_quotes ? quoted() : plain();
        const bool unclear = !in_quotes && rest_.starts_with('#');  // '#' may begin a comment, or belong to the word
        skip_blanks();
        if (unclear || !ends()) throw WrongLine{"a value must be one word, or in quotes"};
        return entry;
    }

private:
    void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }
    std::string take(std::size_t length) {
        std::string taken(rest_.substr(0, length));
        rest_.remove_prefix(taken.size());
        return taken;
    }

    std::string plain() {
        std::string value = take(rest_.find_first_of(" \t\"'#,;=[]{}"));
        if (value.empty()) throw WrongLine{"a value is missing"};
        return value;
    }
    std::string quoted() {
        const char quote = rest_.front();
        rest_.remove_prefix(1);
        const std::size_t end = rest_.find(quote);
        if (end == std::string_view::npos) throw WrongLine{"a quote is not closed"};
        std::string value = take(end);
        rest_.remove_prefix(1);
        if (quote == '"' && value.find('\\') != std::string::npos)
            throw WrongLine{"a value with a backslash must be in single quotes"};
        return value;
    }

    std::string_view rest_;
};

std::vector<Entry> entries_of(const std::string& file) {
    std::istringstream text(text_of(file));
    std::vector<Entry> entries;
    std::size_t number = 0;
    for (std::string line; std::getline(text, line);) {
        ++number;
        try {
            LineReader reader(line);
            if (!reader.ends()) entries.push_back(reader.entry());
        } catch (const WrongLine& wrong) {
            refuse(file, "line " + std::to_string(number), wrong.why);
        }
    }
    return entries;
}

}  // namespace

void apply_config(const Command& command, const std::string& file) {
    std::vector<std::string> names = command.option_names();
    std::erase(names, "config");
    std::erase(names, "help");
    std::set<std::string> seen;
    for (const auto& [key, value] : entries_of(file)) {
        if (std::find(names.begin(), names.end(), key) == names.end()) {
            refuse(file, key,
                   "not an option of '" + command.name() + "'" + did_you_mean(key, {names.begin(), names.end()}));
        }
        Option option = *command.find_option("--" + key);
        if (!seen.insert(key).second) refuse(file, key, "set twice");
        if (option.is_given()) continue;
        try {
            option.set_text(value);
        } catch (const Error& error) {
            refuse(file, key, error.what());
        }
    }
}

}  // namespace octopair::cli
