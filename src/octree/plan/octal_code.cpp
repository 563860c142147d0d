#include "octopair/octal_code.hpp"

#include <charconv>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr unsigned max_integer_digits = 19;  // decimal digits that any uint64 can hold

[[noreturn]] void refuse(std::string_view what, std::string_view why) {
    throw Error(ErrorCode::bad_input, "octal code '" + std::string(what) + "': " + std::string(why));
}

/// Appends one of the paper's digits: 1..8, or 0 after the path. `ended`: a 0 came before.
OctalCode append_paper_digit(OctalCode code, unsigned digit, bool& ended, std::string_view whole) {
    if (digit > 8) refuse(whole, "digits are 1..8, or 0 after the path");
    if (digit == 0) {
        ended = true;
        return code;
    }
    if (ended) refuse(whole, "a 0 ends the path, but a digit follows");
    if (code.level() == OctalCode::max_level) refuse(whole, "more than 21 levels");
    return code.child(digit - 1);
}

}  // namespace

OctalCode OctalCode::from_digits(std::span<const std::uint8_t> digits) {
    OctalCode code;
    for (const std::uint8_t digit : digits) {
        if (digit > 7) refuse(std::to_string(digit), "digits are 0..7");
        if (code.level() == max_level) refuse("...", "more than 21 levels");
        code = code.child(digit);
    }
    return code;
}

OctalCode OctalCode::from_text(std::string_view text) {
    std::string_view rest = text;
    const auto skip_spaces = [&] {
        while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
    };
    const auto take = [&](char c) {
        skip_spaces();
        const bool found = !rest.empty() && rest.front() == c;
        if (found) rest.remove_prefix(1);
        return found;
    };
    if (!take('{')) refuse(text, "expected '{'");
    OctalCode code;
    bool ended = false;
    for (bool first = true; !take('}'); first = false) {
        if (!first && !take(',')) refuse(text, "expected ',' or '}'");
        skip_spaces();
        unsigned digit = 0;
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), digit);
        if (error != std::errc{}) refuse(text, "expected a digit");
        rest.remove_prefix(std::size_t(end - rest.data()));
        code = append_paper_digit(code, digit, ended, text);
    }
    skip_spaces();
    if (!rest.empty()) refuse(text, "unexpected text after the '}'");
    return code;
}

OctalCode OctalCode::from_integer(std::uint64_t integer) {
    OctalCode code;
    if (integer == 0) return code;
    bool ended = false;
    const std::string digits = std::to_string(integer);
    for (const char c : digits) code = append_paper_digit(code, unsigned(c - '0'), ended, digits);
    return code;
}

std::string OctalCode::text() const {
    std::string text = "{";
    for (unsigned i = 0; i < level(); ++i) {
        if (i > 0) text += ',';
        text += char('1' + digit(i));
    }
    return text + "}";
}

std::uint64_t OctalCode::integer(unsigned depth) const {
    if (depth == 0) depth = level();
    if (depth < level()) refuse(text(), "has more levels than the requested depth");
    if (depth > max_integer_digits) refuse(text(), "needs more than 19 digits");
    std::uint64_t value = 0;
    for (unsigned i = 0; i < depth; ++i) value = value * 10 + (i < level() ? digit(i) + 1 : 0);
    return value;
}

}  // namespace octopair
