#include "service/server/net/token_file.hpp"

#include <openssl/sha.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <sstream>

#include "octopair/error.hpp"
#include "service/protocol/private_file.hpp"

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

/// Returns the time that `text` gives in UTC, the end of the day for a date, or nothing if it is neither a date nor a time.
std::optional<Time> time_from(const std::string& text) {
    std::tm parts{};
    const char* const date_end = ::strptime(text.c_str(), "%Y-%m-%d", &parts);
    if (date_end == nullptr) return {};
    if (*date_end == '\0') {
        parts.tm_mday += 1;
    } else {
        const char* const end = ::strptime(date_end, "T%H:%M:%SZ", &parts);
        if (end == nullptr || *end != '\0') return {};
    }
    return std::chrono::system_clock::from_time_t(::timegm(&parts));
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
        if (word.size() < shortest_token) refuse("a token must have at least 16 bytes");
        return digest_of(word);
    }

    Time until(const std::string& word) const {
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
        std::istringstream words(text);
        std::string name, token, more, rest;
        if (!(words >> name) || name.front() == '#') continue;
        if (!(words >> token)) line.refuse("a line must be NAME TOKEN, or NAME TOKEN until=TIME");
        Token read{name, line.digest(token), {}};
        if (words >> more) read.until = line.until(more);
        if (words >> rest) line.refuse("a line must be NAME TOKEN, or NAME TOKEN until=TIME");
        const auto same = [&](const Token& known) { return known.name == name || known.digest == read.digest; };
        if (std::any_of(tokens.begin(), tokens.end(), same)) line.refuse("an earlier line has the same name or token");
        tokens.push_back(std::move(read));
    }
    if (tokens.empty()) throw Error(ErrorCode::bad_input, path + ": the file contains no token");
    return tokens;
}

}  // namespace octopair::service
