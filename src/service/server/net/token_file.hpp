// Token file: the tokens that a server accepts.
//
// Each line is NAME TOKEN [until=TIME]. TOKEN is the token itself, or "sha256:" and the SHA-256 of the token in 64 hexadecimal digits.
// TIME is a date (the token expires when this day ends, in UTC), or a time as in 2027-01-31T12:00:00Z. Lines that begin with # are
// comments. Spaces and tabs divide words, and "\r" may end a line.
#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::service {

using TokenDigest = std::array<unsigned char, 32>;

/// Returns the SHA-256 of a token.
TokenDigest digest_of(std::string_view token);

struct Token {
    std::string name;
    TokenDigest digest;
    std::optional<std::chrono::system_clock::time_point> until;  ///< time at which the token expires
};

/// Throws: as read_private_file; Error{bad_input} for an invalid line, a token of less than 16 bytes, a duplicate name or token, or a file
/// without tokens.
std::vector<Token> read_token_file(const std::string& path);

}  // namespace octopair::service
