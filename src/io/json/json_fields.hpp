// JSON from files that may hold anything: parsed with bounds, and taken apart key by key, so that each fault is one line
// that names the file, the place in it, the key, and what is wrong.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "octopair/shapes.hpp"

namespace octopair::io {

/// Throws Error{bad_input} that begins with `file` for what is no JSON, a key that an object has twice, and more than 16
/// levels of nesting; Error{cancelled} soon after a stop request.
nlohmann::json parse_json(std::string_view text, std::string_view file, const std::stop_token& stop = {});

/// Text from a file as it may stand in a message.
std::string shown_text(std::string_view text);

/// What a value is, or throw Error{bad_input} "PLACE: a string, not ...".
Point3d json_point(const nlohmann::json& value, const std::string& place);
std::uint32_t json_index(const nlohmann::json& value, const std::string& place);
const std::vector<nlohmann::json>& json_array(const nlohmann::json& value, const std::string& place);
const std::string& json_text(const nlohmann::json& value, const std::string& place);

/// The keys of a JSON object, borrowed. All calls throw Error{bad_input} that begins with the place.
class JsonFields {
public:
    /// `place`: "FILE: object 3 ('ball')".
    JsonFields(const nlohmann::json& object, std::string place);

    /// Refuses keys that are not among these.
    void allow(std::initializer_list<std::string_view> known) const;

    /// Null if the key is not there.
    const nlohmann::json* find(std::string_view key) const;
    const nlohmann::json& need(std::string_view key) const;

    double number(std::string_view key) const;
    double at_least_zero(std::string_view key) const;
    double above_zero(std::string_view key) const;
    Point3d point(std::string_view key) const;
    Point3d point_above_zero(std::string_view key) const;
    const std::string& text(std::string_view key) const;
    std::uint32_t whole_number(std::string_view key) const;
    bool yes_or_no(std::string_view key) const;

    const std::string& place() const { return place_; }
    std::string place_of(std::string_view key) const { return place_ + ": " + std::string(key); }
    [[noreturn]] void refuse_key(std::string_view key, std::string_view what) const;

private:
    const nlohmann::json& object_;
    std::string place_;
};

}  // namespace octopair::io
