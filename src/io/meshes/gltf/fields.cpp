#include "io/meshes/gltf/fields.hpp"

#include <cmath>

#include "io/json/json_text.hpp"

namespace octopair::io::gltf {

using nlohmann::json;

std::uint64_t whole_number(const json& value, const std::string& place) {
    constexpr double most = 0x1p53;
    if (value.is_number()) {
        const auto number = value.get<double>();
        if (number >= 0 && number <= most && std::floor(number) == number) return std::uint64_t(number);
        refuse(place, dump_json(value) + " is not a whole number from 0 to 2^53");
    }
    refuse_json_type(place, value, "a whole number");
}

std::uint64_t whole_number(const JsonFields& fields, std::string_view key) {
    return whole_number(fields.required(key), fields.place_of(key));
}

std::uint64_t whole_number_or(const JsonFields& fields, std::string_view key, std::uint64_t absent) {
    const json* const value = fields.find(key);
    return value == nullptr ? absent : whole_number(*value, fields.place_of(key));
}

const json::array_t& array_or_empty(const JsonFields& fields, std::string_view key) {
    static const json::array_t empty;
    const json* const value = fields.find(key);
    return value == nullptr ? empty : json_array(*value, fields.place_of(key));
}

std::string name_in(const JsonFields& fields, std::string_view key) {
    const json* const value = fields.find(key);
    return value == nullptr || !value->is_string() ? std::string() : value->get<std::string>();
}

const json* extension_of(const JsonFields& fields, std::string_view name) {
    const json* const all = fields.find("extensions");
    if (all == nullptr || !all->is_object()) return nullptr;
    const auto found = all->find(name);
    return found == all->end() ? nullptr : &*found;
}

}  // namespace octopair::io::gltf
