#include "io/json/json_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"

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

/// Builds the values that the parser finds. Refuses repeated keys and deep nesting. A callback of json::parse() could refuse them, too,
/// but makes the time of the parser quadratic in the length of arrays.
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
        json* next = nullptr;  ///< in an object: place of the value after the last key; null if it has its value
        const std::string* key = nullptr;  ///< in an object: the last key
    };

    /// Adds a value to the innermost open array or object. Returns a reference to the stored value.
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
                    fmt::format("[{}]", level.value->size() - (last ? 0 : 1));  // the array has an open value already
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

}  // namespace

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
    // Cutting must not leave a part of a UTF-8 character at the end.
    while (text.size() > max_bytes && !shown.empty() && (shown.back() & 0x80) != 0) shown.pop_back();
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '?');
    return text.size() > max_bytes ? shown + "..." : shown;
}

std::string json_string(std::string_view text) {
    // Most names are plain ASCII, and results have millions of them.
    const bool plain = std::all_of(text.begin(), text.end(),
                                   [](char c) { return (c & 0x80) == 0 && c >= ' ' && c != '"' && c != '\\'; });
    if (plain) return '"' + std::string(text) + '"';
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
