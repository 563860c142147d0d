#include "io/json/json_fields.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/json/json_text.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

constexpr int max_levels = 16;

/// Parser callback: tracks the path to the current value, and refuses repeated keys and deep nesting.
class ParseMonitor {
public:
    ParseMonitor(std::string_view file, const std::stop_token& stop) : file_(file), stop_(stop) {}

    bool operator()(int depth, json::parse_event_t event, const json& parsed) {
        if (++events_ % 65536 == 0 && stop_.stop_requested()) cancel();
        switch (event) {
            case json::parse_event_t::object_start:
            case json::parse_event_t::array_start:
                if (depth >= max_levels) refuse(place(), fmt::format("more than {} levels of nesting", max_levels));
                levels_.push_back({.is_array = event == json::parse_event_t::array_start});
                break;
            case json::parse_event_t::object_end:
            case json::parse_event_t::array_end:
                levels_.pop_back();
                [[fallthrough]];
            case json::parse_event_t::value:
                if (!levels_.empty()) ++levels_.back().values;
                break;
            case json::parse_event_t::key:
                begin_key(parsed.get_ref<const std::string&>());
                break;
        }
        return true;
    }

    /// Returns the file and the path to the current value, for example "f.json: objects[1].shape".
    std::string place() const {
        std::string path;
        for (const Level& level : levels_) {
            if (level.is_array) {
                path += fmt::format("[{}]", level.values);
            } else if (level.keys.size() > level.values) {
                path += fmt::format("{}{}", path.empty() ? "" : ".", shown_text(level.key));
            }
        }
        return path.empty() ? std::string(file_) : fmt::format("{}: {}", file_, path);
    }

private:
    /// An array or an object that has begun and not ended.
    struct Level {
        bool is_array = false;
        std::size_t values = 0;  ///< number of complete values
        std::set<std::string> keys = {};
        std::string key = {};  ///< last key
    };

    void begin_key(const std::string& key) {
        Level& level = levels_.back();
        if (!level.keys.insert(key).second) {
            refuse(place(), fmt::format("the key '{}' occurs twice in one object", shown_text(key)));
        }
        level.key = key;
    }

    std::string_view file_;
    const std::stop_token& stop_;
    std::uint64_t events_ = 0;
    std::vector<Level> levels_;
};

/// Returns the message of the parser without the error id in brackets, as printable ASCII.
std::string message_of(const json::exception& error) {
    std::string_view words = error.what();
    if (const std::size_t end = words.find("] "); words.starts_with('[') && end != std::string_view::npos) {
        words.remove_prefix(end + 2);
    }
    std::string text(words.substr(0, 200));
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return text;
}

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

json parse_json(std::string_view text, std::string_view file, const std::stop_token& stop) {
    // The parser would take a byte 0 as the end of the text, and ignore the rest.
    if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
        refuse(file, fmt::format("byte {} is 0; a JSON file is text", zero));
    ParseMonitor monitor(file, stop);
    try {
        return json::parse(text, [&monitor](int depth, json::parse_event_t event, const json& parsed) {
            return monitor(depth, event, parsed);
        });
    } catch (const json::parse_error& error) {  // the message has the line and the column
        refuse(file, message_of(error));
    } catch (const json::exception& error) {
        refuse(monitor.place(), message_of(error));
    }
}

std::string shown_text(std::string_view text) {
    constexpr std::size_t max_bytes = 60;
    std::string shown(text.substr(0, max_bytes));
    // The cut must not leave part of a UTF-8 character at the end.
    while (text.size() > max_bytes && !shown.empty() && (shown.back() & 0x80) != 0) shown.pop_back();
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '?');
    return text.size() > max_bytes ? shown + "..." : shown;
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

const json& JsonFields::need(std::string_view key) const {
    const json* value = find(key);
    if (value == nullptr) refuse(place_, fmt::format("the key '{}' is missing", key));
    return *value;
}

double JsonFields::number(std::string_view key) const { return number_of(need(key), place_of(key), "a number"); }

double JsonFields::at_least_zero(std::string_view key) const {
    const double value = number_of(need(key), place_of(key), "a number >= 0");
    if (!(value >= 0)) refuse_key(key, number_text(value) + " is not a number >= 0");
    return value;
}

double JsonFields::above_zero(std::string_view key) const {
    const double value = number_of(need(key), place_of(key), "a number > 0");
    if (!(value > 0)) refuse_key(key, number_text(value) + " is not a number > 0");
    return value;
}

Point3d JsonFields::point(std::string_view key) const { return json_point(need(key), place_of(key)); }

Point3d JsonFields::point_above_zero(std::string_view key) const {
    const Point3d value = point(key);
    for (const double number : value) {
        if (!(number > 0)) refuse_key(key, number_text(number) + " is not a number > 0");
    }
    return value;
}

const std::string& JsonFields::text(std::string_view key) const { return json_text(need(key), place_of(key)); }

std::uint32_t JsonFields::whole_number(std::string_view key) const { return json_index(need(key), place_of(key)); }

bool JsonFields::boolean(std::string_view key) const {
    const json& value = need(key);
    if (!value.is_boolean()) refuse_json_type(place_of(key), value, "true or false");
    return value.get<bool>();
}

void JsonFields::refuse_key(std::string_view key, std::string_view what) const { refuse(place_of(key), what); }

}  // namespace octopair::io
