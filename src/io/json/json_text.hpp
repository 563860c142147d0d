// Text that goes into result files.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace octopair::io {

/// The text as a JSON string, with its quotes; what is not UTF-8 in it becomes U+FFFD.
std::string json_string(std::string_view text);

/// The same text without what is not UTF-8.
std::string clean_text(std::string_view text);

std::string dump_json(const nlohmann::json& value);

/// Returns the JSON object `row` with `key` set to `text`. The keys keep their order. Requires: `row` is a JSON object.
std::string with_key(std::string_view row, const char* key, std::string_view text);

/// As short as it can be written to be read again as it is; null if it is not finite.
std::string json_number(double number);

}  // namespace octopair::io
