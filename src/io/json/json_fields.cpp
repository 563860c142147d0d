#include "io/json/json_fields.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/json/json_text.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

/// Iterates over a text. Throws Error{cancelled} soon after a stop request, also within a long string.
class WatchedText {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    WatchedText(const char* at, const std::stop_token& stop) : at_(at), stop_(&stop) {}

    const char& operator*() const { return *at_; }
    WatchedText& operator++() {
        constexpr std::uintptr_t piece = 65536;
        if (reinterpret_cast<std::uintptr_t>(++at_) % piece == 0 && stop_->stop_requested()) cancel();
        return *this;
    }
    WatchedText operator++(int) {
        const WatchedText before = *this;
        ++*this;
        return before;
    }
    bool operator==(const WatchedText& other) const { return at_ == other.at_; }

private:
    const char* at_;
    const std::stop_token* stop_;
};

/// Builds the values that the parser finds. Refuses repeated keys and deep nesting. The callback of json::parse() could do so, too, but
/// then the time of the parser grows as the square of the length of arrays.
class ValueBuilder {
public:
    ValueBuilder(std::string_view file, int max_levels) : file_(file), max_levels_(max_levels) {}

    json take() { return std::move(root_); }

    // The parser calls these functions. Each returns true, to continue.
    bool null() { return add(nullptr); }
    bool boolean(bool value) { return add(value); }
    bool number_integer(json::number_integer_t value) { return add(value); }
    bool number_unsigned(json::number_unsigned_t value) { return add(value); }
    bool number_float(json::number_float_t value, const std::string&) { return add(value); }
    bool string(std::string& value) { return add(std::move(value)); }
    bool binary(json::binary_t& value) { return add(std::move(value)); }
    bool start_object(std::size_t) { return begin(json::object()); }
    bool start_array(std::size_t) { return begin(json::array()); }
    bool end_object() { return end(); }
    bool end_array() { return end(); }
    bool key(const std::string& key) {
        Level& level = levels_.back();
        const auto [place_of_value, is_new] = level.value->get_ref<json::object_t&>().emplace(key, nullptr);
        if (!is_new) refuse(place(), fmt::format("the key '{}' occurs twice in one object", shown_text(key)));
        level.next = &place_of_value->second;
        level.key = &place_of_value->first;
        return true;
    }
    [[noreturn]] bool parse_error(std::size_t, const std::string&, const json::exception& error);

private:
    /// An array or an object that has begun and not ended.
    struct Level {
        json* value;
        json* next = nullptr;  ///< in an object: the place of the value after the last key; null if the value is there
        const std::string* key = nullptr;  ///< in an object: the last key
    };

    /// Adds a value. Returns it in its place.
    json& place_value(json&& value) {
        if (levels_.empty()) return root_ = std::move(value);
        Level& level = levels_.back();
        if (level.next != nullptr) return *std::exchange(level.next, nullptr) = std::move(value);
        return level.value->get_ref<json::array_t&>().emplace_back(std::move(value));
    }
    bool add(json&& value) {
        (void)place_value(std::move(value));
        return true;
    }
    bool begin(json&& value) {
        if (levels_.size() >= std::size_t(max_levels_))
            refuse(place(), fmt::format("more than {} levels of nesting", max_levels_));
        levels_.push_back({&place_value(std::move(value))});
        return true;
    }
    bool end() {
        levels_.pop_back();
        return true;
    }

    /// Returns the file and the path to the value that is parsed, for example "f.json: objects[1].shape".
    std::string place() const {
        std::string path;
        for (std::size_t i = 0; i < levels_.size(); ++i) {
            const Level& level = levels_[i];
            const bool last = i + 1 == levels_.size();
            if (level.value->is_array()) {
                path +=
                    fmt::format("[{}]", level.value->size() - (last ? 0 : 1));  // that of an open value is in the array
            } else if (level.key != nullptr && (!last || level.next != nullptr)) {
                path += fmt::format("{}{}", path.empty() ? "" : ".", shown_text(*level.key));
            }
        }
        return path.empty() ? std::string(file_) : fmt::format("{}: {}", file_, path);
    }

    std::string_view file_;
    int max_levels_;
    json root_;
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

bool ValueBuilder::parse_error(std::size_t, const std::string&, const json::exception& error) {
    // The message of a wrong text has the line and the column. Other errors are about a value, such as a number beyond float64.
    const bool is_text = dynamic_cast<const json::parse_error*>(&error) != nullptr;
    refuse(is_text ? std::string(file_) : place(), message_of(error));
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

json parse_json(std::string_view text, std::string_view file, const std::stop_token& stop, int max_levels) {
    // The parser would take a byte 0 as the end of the text, and ignore the rest.
    if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos)
        refuse(file, fmt::format("byte {} is 0; a JSON file is text", zero));
    ValueBuilder builder(file, max_levels);
    const WatchedText begin(text.data(), stop), end(text.data() + text.size(), stop);
    (void)json::sax_parse(begin, end, &builder);
    return builder.take();
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
