#include "io/json/json_text.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/json/json_fields.hpp"

namespace octopair::io {

std::string json_string(std::string_view text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string clean_text(std::string_view text) {
    const bool ascii = std::none_of(text.begin(), text.end(), [](char c) { return (c & 0x80) != 0; });
    return ascii ? std::string(text) : parse_json(json_string(text), {}).get<std::string>();
}

std::string dump_json(const nlohmann::json& value) { return value.dump(); }

std::string with_key(std::string_view row, const char* key, std::string_view text) {
    auto value = nlohmann::ordered_json::parse(row);
    value[key] = text;
    return value.dump();
}

std::string json_number(double number) { return std::isfinite(number) ? fmt::format("{}", number) : "null"; }

}  // namespace octopair::io
