// Formats JSON text for result files.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace octopair::io {

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
