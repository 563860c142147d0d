// Reads values from the JSON of a glTF file. Adds to JsonFields the types of values that glTF has.
//
// All functions throw Error{bad_input} that begins with the place, if a value has another type or form.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"

namespace octopair::io::gltf {

/// Returns a whole number from 0 to 2^53. The file may write it as a decimal, for example 36.0.
std::uint64_t whole_number(const nlohmann::json& value, const std::string& place);
/// Returns the number of a key. Throws: Error{bad_input} also if the object does not have the key.
std::uint64_t whole_number(const JsonFields& fields, std::string_view key);
/// Returns the number of a key, or `absent` if the object does not have the key.
std::uint64_t whole_number_or(const JsonFields& fields, std::string_view key, std::uint64_t absent);

/// Returns the array of a key; an empty one if the object does not have the key.
const std::vector<nlohmann::json>& array_or_empty(const JsonFields& fields, std::string_view key);

/// Returns the text of a key. Returns an empty text if the object does not have the key, or if its value is no text.
std::string name_in(const JsonFields& fields, std::string_view key = "name");

/// Returns the extension of an object with the given name, or null if the object does not have it.
const nlohmann::json* extension_of(const JsonFields& fields, std::string_view name);

/// Returns the `n` numbers of a key, or `absent` if the object does not have the key.
template <std::size_t n>
std::array<double, n> numbers_or(const JsonFields& fields, std::string_view key, const std::array<double, n>& absent) {
    const nlohmann::json* const value = fields.find(key);
    if (value == nullptr) return absent;
    const std::string wanted = "an array of " + std::to_string(n) + " numbers";
    if (!value->is_array()) refuse_json_type(fields.place_of(key), *value, wanted);
    if (value->size() != n) fields.refuse_key(key, "an array of " + std::to_string(value->size()) + ", not " + wanted);
    std::array<double, n> numbers;
    for (std::size_t i = 0; i < n; ++i) {
        if (!(*value)[i].is_number()) refuse_json_type(fields.place_of(key), (*value)[i], "a number in " + wanted);
        numbers[i] = (*value)[i].get<double>();
    }
    return numbers;
}

}  // namespace octopair::io::gltf
