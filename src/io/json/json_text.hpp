// JSON as text: parses untrusted text with bounds, and formats text for result files.
#pragma once

#include <stop_token>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace octopair::io {

/// Parses `text`. `file` is the name that messages begin with.
/// Throws: Error{bad_input} for a syntax error, a byte 0, a key that one object has twice, or more than `max_levels` levels of
/// nesting; Error{cancelled} soon after a stop request.
nlohmann::json parse_json(std::string_view text, std::string_view file, const std::stop_token& stop = {},
                          int max_levels = 16);

/// Returns a text of a file for use in messages: at most 60 bytes, with '?' for control characters.
std::string shown_text(std::string_view text);

/// Returns `text` as a JSON string with quotes. Invalid UTF-8 becomes U+FFFD.
std::string json_string(std::string_view text);

/// Returns `text` with U+FFFD in place of invalid UTF-8.
std::string clean_text(std::string_view text);

std::string dump_json(const nlohmann::json& value);

/// Returns the JSON object `row` with `key` set to `text`. The keys keep their order. Requires: `row` is a JSON object.
std::string with_key(std::string_view row, const char* key, std::string_view text);

/// Returns the shortest text that reads back as exactly `number`; "null" if `number` is not finite.
std::string json_number(double number);

}  // namespace octopair::io
