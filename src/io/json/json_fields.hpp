// JsonFields: reads parsed JSON objects key by key.
//
// Each error is one line that names the file, the place in the file, the key, and what is wrong.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "io/json/json_text.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Throws: Error{bad_input} "PLACE: a number, not WANTED": `value` has another type than it must have.
[[noreturn]] void refuse_json_type(const std::string& place, const nlohmann::json& value, std::string_view wanted);

// Each function returns the content of `value`.
// Throws: Error{bad_input} "PLACE: a string, not ..." if `value` has another type.
Point3d json_point(const nlohmann::json& value, const std::string& place);
std::uint32_t json_index(const nlohmann::json& value, const std::string& place);
const std::vector<nlohmann::json>& json_array(const nlohmann::json& value, const std::string& place);
const std::string& json_text(const nlohmann::json& value, const std::string& place);

/// Reads the values of a JSON object by key. Borrows the object.
/// Throws: each call throws Error{bad_input} that begins with the place if the value is missing or wrong.
class JsonFields {
public:
    /// `place` is the beginning of messages, for example "FILE: object 3 ('ball')".
    JsonFields(const nlohmann::json& object, std::string place);

    /// Throws: Error{bad_input} if the object has a key that is not in `known`.
    void allow(std::span<const std::string_view> known) const;
    void allow(std::initializer_list<std::string_view> known) const { allow(std::span(known.begin(), known.size())); }

    /// Returns the value of `key`, or null if the object does not have the key.
    const nlohmann::json* find(std::string_view key) const;
    /// Returns the value of `key`. Throws: Error{bad_input} if the object does not have the key.
    const nlohmann::json& required(std::string_view key) const;

    double number(std::string_view key) const;
    double at_least_zero(std::string_view key) const;
    double above_zero(std::string_view key) const;
    Point3d point(std::string_view key) const;
    Point3d point_above_zero(std::string_view key) const;
    const std::string& text(std::string_view key) const;
    std::uint32_t whole_number(std::string_view key) const;
    bool boolean(std::string_view key) const;

    const std::string& place() const { return place_; }
    std::string place_of(std::string_view key) const { return place_ + ": " + std::string(key); }
    [[noreturn]] void refuse_key(std::string_view key, std::string_view what) const;

private:
    const nlohmann::json& object_;
    std::string place_;
};

}  // namespace octopair::io
