#include "service/server/net/token_file.hpp"

#include <openssl/sha.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "octopair/error.hpp"
#include "service/protocol/credential_files.hpp"

namespace octopair::service {

namespace {

using Time = std::chrono::system_clock::time_point;

constexpr std::size_t shortest_token = 16;
constexpr std::string_view hashed = "sha256:", expires = "until=";

/// Returns the digest that hexadecimal digits give, or nothing if they are not 64 digits.
std::optional<TokenDigest> digest_from(std::string_view digits) {
    TokenDigest digest{};
    if (digits.size() != 2 * digest.size()) return {};
    for (std::size_t i = 0; i < digest.size(); ++i) {
        const char* const at = digits.data() + 2 * i;
        if (std::from_chars(at, at + 2, digest.at(i), 16).ptr != at + 2) return {};
    }
    return digest;
}

/// Returns whether `text` has the form of `form`, where 0 stands for any digit.
bool has_form(std::string_view text, std::string_view form) {
    return std::equal(text.begin(), text.end(), form.begin(), form.end(),
                      [](char c, char f) { return f == '0' ? c >= '0' && c <= '9' : c == f; });
}

/// Parses a time in UTC. A date means the end of this day. Returns nothing if `text` is neither a date nor a time.
std::optional<Time> time_from(std::string_view text) {
    using namespace std::chrono;
    constexpr std::string_view date_form = "0000-00-00", time_form = "0000-00-00T00:00:00Z";
    if (!has_form(text, date_form) && !has_form(text, time_form)) return {};
    const auto number = [&](std::size_t at, std::size_t digits) {
        int value = 0;
        (void)std::from_chars(text.data() + at, text.data() + at + digits, value);
        return value;
    };
    const year_month_day date{year(number(0, 4)), month(unsigned(number(5, 2))), day(unsigned(number(8, 2)))};
    if (!date.ok()) return {};
    if (date.year() > year(2261)) return Time::max();  // the last whole year that system_clock holds
    if (date.year() < year(1970)) return Time::min();  // system_clock holds no year before 1678
    if (text.size() == date_form.size()) return sys_days(date) + days(1);
    const int hour = number(11, 2), minute = number(14, 2), second = number(17, 2);
    if (hour > 23 || minute > 59 || second > 59) return {};
    return sys_days(date) + hours(hour) + minutes(minute) + seconds(second);
}

/// Returns whether a token looks like a hash in another form than that of a token file, such as SHA256:... or sha512:...
bool is_other_hash(std::string_view word) {
    constexpr std::size_t shortest_hash = 32;
    std::string name(word.substr(0, word.find_first_of(":=$")));
    std::ranges::transform(name, name.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    const std::size_t last = word.find_last_not_of("0123456789abcdefABCDEF");  // last character before the hash digits
    const bool has_digits = word.size() - (last + 1) >= shortest_hash;
    if (name.starts_with("sha") && has_digits) return true;
    if (name.size() == word.size()) return false;
    const bool is_sha =
        name.starts_with("sha") && name.size() <= 7 && name.find_first_not_of("-0123456789", 3) == std::string::npos;
    return is_sha || (has_digits && last == name.size());
}

/// Returns the words of a line. Only blanks divide words.
std::vector<std::string> words_of(std::string_view line) {
    constexpr std::string_view blanks = " \t";
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::vector<std::string> words;
    for (std::size_t begin = line.find_first_not_of(blanks); begin != std::string_view::npos;) {
        const std::size_t end = line.find_first_of(blanks, begin);
        words.emplace_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(blanks, end);
    }
    return words;
}

/// A line of the file. Its members throw Error{bad_input} that names the line.
struct Line {
    const std::string& file;
    std::size_t number;

    [[noreturn]] void refuse(const char* why) const {
        throw Error(ErrorCode::bad_input, file + ": line " + std::to_string(number) + ": " + why);
    }

    TokenDigest digest(std::string_view word) const {
        if (!std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c <= '~'; }))
            refuse("a token must consist of printable ASCII characters");
        if (word.starts_with(hashed)) {
            const auto digest = digest_from(word.substr(hashed.size()));
            if (!digest) refuse("sha256: must be followed by 64 hexadecimal digits");
            return *digest;
        }
        if (is_other_hash(word)) refuse("a hash must be written as sha256: and 64 hexadecimal digits");
        if (word.size() < shortest_token) refuse("a token must have at least 16 bytes");
        return digest_of(word);
    }

    void check_name(std::string_view name) const {
        const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; };
        if (std::any_of(name.begin(), name.end(), is_control) || name.starts_with("\xEF\xBB\xBF"))
            refuse("a name has no control characters, and no byte order mark before it");
        if (name.starts_with("token:")) refuse("a name is written without token:, which only the role file has");
    }

    Time until(std::string_view word) const {
        if (!word.starts_with(expires)) refuse("a line must be NAME TOKEN, or NAME TOKEN until=TIME");
        const auto time = time_from(word.substr(expires.size()));
        if (!time) refuse("until= must be followed by a date as 2027-01-31, or a time as 2027-01-31T12:00:00Z");
        return *time;
    }
};

}  // namespace

TokenDigest digest_of(std::string_view token) {
    TokenDigest digest{};
    SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
    return digest;
}

std::vector<Token> read_token_file(const std::string& path) {
    std::vector<Token> tokens;
    std::istringstream in(read_private_file(path));
    std::size_t number = 0;
    for (std::string text; std::getline(in, text);) {
        const Line line{path, ++number};
        const std::vector<std::string> words = words_of(text);
        if (words.empty() || words[0].front() == '#') continue;
        line.check_name(words[0]);
        if (words.size() != 2 && words.size() != 3) line.refuse("a line must be NAME TOKEN, or NAME TOKEN until=TIME");
        Token read{words[0], line.digest(words[1]), {}};
        if (words.size() == 3) read.until = line.until(words[2]);
        const auto same = [&](const Token& known) { return known.name == read.name || known.digest == read.digest; };
        if (std::any_of(tokens.begin(), tokens.end(), same)) line.refuse("an earlier line has the same name or token");
        tokens.push_back(std::move(read));
    }
    if (tokens.empty()) throw Error(ErrorCode::bad_input, path + ": the file contains no token");
    return tokens;
}

}  // namespace octopair::service
