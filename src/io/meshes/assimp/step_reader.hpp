// Reads the instances of a STEP text (ISO 10303-21), one after another.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace octopair::io::step {

inline constexpr std::string_view space = " \t\r\n", digits = "0123456789",
                                  keyword = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

/// An instance of a STEP file: #NUMBER = KEYWORD(attributes). Borrows its texts.
struct StepInstance {
    std::string_view number, type;
    std::string_view attributes;  ///< text after the opening parenthesis, to the closing one

    /// Returns whether the type is `name`, or with `prefix` begins with it. Case does not matter.
    bool is(std::string_view name, bool prefix = false) const {
        if (type.size() < name.size() || (!prefix && type.size() > name.size())) return false;
        return std::equal(name.begin(), name.end(), type.begin(),
                          [](char a, char b) { return a == (b >= 'a' ? b - 32 : b); });
    }
};

/// Reads a STEP text from its beginning.
class StepReader {
public:
    explicit StepReader(std::string_view step) : rest_(step) {}

    bool at_end() const { return rest_.empty(); }

    /// Skips white space and comments. If the next character is `c`, skips this character, too, and returns true.
    bool take(char c) {
        skip(space);
        while (rest_.starts_with("/*")) {
            const std::size_t end = rest_.find("*/", 2);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 2);
            skip(space);
        }
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }
    /// Reads a text in quotes, without decoding it.
    std::optional<std::string_view> take_text() {
        if (!take('\'')) return std::nullopt;
        for (std::size_t at = rest_.find('\''); at != std::string_view::npos; at = rest_.find('\'', at + 2)) {
            if (at + 1 < rest_.size() && rest_[at + 1] == '\'') continue;
            const std::string_view text = rest_.substr(0, at);
            rest_.remove_prefix(at + 1);
            return text;
        }
        return std::nullopt;
    }
    /// Reads and returns the next characters, as long as they are in `set`.
    std::string_view take_all(std::string_view set) {
        const std::string_view before = rest_;
        skip(set);
        return before.substr(0, before.size() - rest_.size());
    }
    /// Skips the next characters, as long as they are in `set`.
    void skip(std::string_view set) {
        const std::size_t end = rest_.find_first_not_of(set);
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
    }
    /// Goes to the next character of `set`. Ignores characters in texts and comments. Returns false at the end.
    bool find(std::string_view set) {
        const std::string wanted = std::string(set) + "'/";
        while (!rest_.empty()) {
            const std::size_t at = rest_.find_first_of(wanted);
            if (at == std::string_view::npos) break;
            rest_.remove_prefix(at);
            if (rest_.front() == '\'') {
                if (!take_text()) break;
            } else if (rest_.front() == '/') {
                if (!take('/')) continue;  // a comment, which take() has skipped
            } else {
                return true;
            }
        }
        rest_ = {};
        return false;
    }
    /// Reads to the end of the next instance or line of the header. Returns the instance; nothing for a line of the header.
    std::optional<StepInstance> next() {
        StepInstance instance;
        const bool numbered = take('#');
        if (numbered) instance.number = take_all(digits);
        const bool named = numbered && take('=') && (skip(space), true);
        if (named) instance.type = take_all(keyword);
        const bool has_attributes = named && take('(');
        const std::string_view begin = rest_;
        const bool ends = find(";");
        instance.attributes = begin.substr(0, begin.size() - rest_.size());
        if (ends) rest_.remove_prefix(1);
        return has_attributes && ends ? std::optional(instance) : std::nullopt;
    }

    std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
};

/// Returns the numbers of the instances that some attributes refer to, in order.
inline std::vector<std::string_view> references_of(std::string_view attributes) {
    std::vector<std::string_view> references;
    for (StepReader reader(attributes); reader.find("#");) {
        (void)reader.take('#');
        references.push_back(reader.take_all(digits));
    }
    return references;
}

/// Returns the attribute at a position, counted from 0, without white space around it; empty if there is none.
inline std::string_view attribute_at(const StepInstance& instance, int position) {
    StepReader reader(instance.attributes);
    int depth = 0;
    while (position > 0) {
        if (!reader.find(",()")) return {};
        if (reader.take('(')) {
            ++depth;
        } else if (reader.take(')')) {
            --depth;
        } else if (reader.take(',')) {
            position -= depth == 0;
        }
    }
    reader.skip(space);
    const std::string_view rest = reader.rest();
    return rest.substr(0, rest.find_first_of(",) \t\r\n"));
}

}  // namespace octopair::io::step
