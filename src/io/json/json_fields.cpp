#include "io/json/json_fields.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/json/json_text.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

double number_of(const json& value, const std::string& place, std::string_view wanted) {
    if (!value.is_number()) refuse_json_type(place, value, wanted);
    return value.get<double>();
}

}  // namespace

void refuse_json_type(const std::string& place, const json& value, std::string_view wanted) {
    const std::string_view type = value.type_name();
    const bool vowel = type == "array" || type == "object";
    refuse(place, type == "null" ? fmt::format("null, not {}", wanted)
                                 : fmt::format("{} {}, not {}", vowel ? "an" : "a", type, wanted));
}

const json::array_t& json_array(const json& value, const std::string& place) {
    if (!value.is_array()) refuse_json_type(place, value, "an array");
    return value.get_ref<const json::array_t&>();
}

const std::string& json_text(const json& value, const std::string& place) {
    if (!value.is_string()) refuse_json_type(place, value, "a string");
    return value.get_ref<const std::string&>();
}

Point3d json_point(const json& value, const std::string& place) {
    constexpr std::string_view wanted = "an array of 3 numbers";
    if (!value.is_array()) refuse_json_type(place, value, wanted);
    if (value.size() != 3) refuse(place, fmt::format("an array of {}, not {}", value.size(), wanted));
    Point3d point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!value[axis].is_number()) refuse_json_type(place, value[axis], "a number in " + std::string(wanted));
        point[axis] = value[axis].get<double>();
    }
    return point;
}

std::uint32_t json_index(const json& value, const std::string& place) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (value.is_number_unsigned() && value.get<std::uint64_t>() <= most) return value.get<std::uint32_t>();
    const std::string wanted = fmt::format("a whole number from 0 to {}", most);
    if (value.is_number()) refuse(place, fmt::format("{} is not {}", dump_json(value), wanted));
    refuse_json_type(place, value, wanted);
}

JsonFields::JsonFields(const json& object, std::string place) : object_(object), place_(std::move(place)) {
    if (!object_.is_object()) refuse_json_type(place_, object_, "an object");
}

void JsonFields::allow(std::span<const std::string_view> known) const {
    for (const auto& [key, value] : object_.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        refuse(place_, fmt::format("unknown key '{}'; known keys: {}", shown_text(key),
                                   fmt::join(known.begin(), known.end(), ", ")));
    }
}

const json* JsonFields::find(std::string_view key) const {
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
}

const json& JsonFields::required(std::string_view key) const {
    const json* value = find(key);
    if (value == nullptr) refuse(place_, fmt::format("the key '{}' is missing", key));
    return *value;
}

double JsonFields::number(std::string_view key) const { return number_of(required(key), place_of(key), "a number"); }

double JsonFields::at_least_zero(std::string_view key) const {
    const double value = number_of(required(key), place_of(key), "a number >= 0");
    if (!(value >= 0)) refuse_key(key, number_text(value) + " is not a number >= 0");
    return value;
}

double JsonFields::above_zero(std::string_view key) const {
    const double value = number_of(required(key), place_of(key), "a number > 0");
    if (!(value > 0)) refuse_key(key, number_text(value) + " is not a number > 0");
    return value;
}

Point3d JsonFields::point(std::string_view key) const { return json_point(required(key), place_of(key)); }

Point3d JsonFields::point_above_zero(std::string_view key) const {
    const Point3d value = point(key);
    for (const double number : value) {
        if (!(number > 0)) refuse_key(key, number_text(number) + " is not a number > 0");
    }
    return value;
}

const std::string& JsonFields::text(std::string_view key) const { return json_text(required(key), place_of(key)); }

std::uint32_t JsonFields::whole_number(std::string_view key) const { return json_index(required(key), place_of(key)); }

bool JsonFields::boolean(std::string_view key) const {
    const json& value = required(key);
    if (!value.is_boolean()) refuse_json_type(place_of(key), value, "true or false");
    return value.get<bool>();
}

void JsonFields::refuse_key(std::string_view key, std::string_view what) const { refuse(place_of(key), what); }

}  // namespace octopair::io
