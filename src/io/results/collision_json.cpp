// Rows of collisions as JSON. as_json() returns a value of a column as JSON, or nothing if the row lacks the value. read_json()
// reads such a value.
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"

namespace octopair::io {

namespace {

std::string point_json(const Point3d& point) {
    return fmt::format("[{},{},{}]", json_number(point[0]), json_number(point[1]), json_number(point[2]));
}

std::string contact_json(const Contact& contact) {
    std::string text = fmt::format("{{\"point\":{},\"normal\":{},\"depth\":{}", point_json(contact.point),
                                   point_json(contact.normal), json_number(contact.depth));
    if (contact.feature_a != Contact::no_feature) text += fmt::format(",\"a_feature\":{}", contact.feature_a);
    if (contact.feature_b != Contact::no_feature) text += fmt::format(",\"b_feature\":{}", contact.feature_b);
    return text + '}';
}

std::string as_json(std::uint32_t value) { return std::to_string(value); }
std::string as_json(const std::optional<std::uint32_t>& value) { return value ? std::to_string(*value) : ""; }
std::string as_json(std::string_view value) { return value.empty() ? "" : json_string(value); }
std::string as_json(bool value) { return value ? "true" : ""; }
std::string as_json(const std::optional<double>& value) { return value ? json_number(*value) : ""; }
template <typename Word>
    requires std::is_enum_v<Word>
std::string as_json(const std::optional<Word>& value) {
    return value ? fmt::format("\"{}\"", word_of(*value)) : "";
}
std::string as_json(const std::optional<NearestPoints>& value) {
    return value ? fmt::format("[{},{}]", point_json((*value)[0]), point_json((*value)[1])) : "";
}
std::string as_json(const std::optional<std::vector<Contact>>& value) {
    if (!value) return "";
    std::string text = "[";
    for (const Contact& contact : *value) text += (text.size() > 1 ? "," : "") + contact_json(contact);
    return text + ']';
}

Contact contact_of(const nlohmann::json& value, const std::string& place) {
    const JsonFields fields(value, place);
    Contact contact;
    contact.point = fields.point("point");
    if (fields.find("normal") != nullptr) contact.normal = fields.point("normal");
    if (fields.find("depth") != nullptr) contact.depth = fields.number("depth");
    if (fields.find("a_feature") != nullptr) contact.feature_a = fields.whole_number("a_feature");
    if (fields.find("b_feature") != nullptr) contact.feature_b = fields.whole_number("b_feature");
    return contact;
}

/// A value of a JSON object by its key.
struct JsonPlace {
    const JsonFields& row;
    std::string_view key;
};

void read_json(const JsonPlace& from, std::uint32_t& value) { value = from.row.whole_number(from.key); }
void read_json(const JsonPlace& from, std::optional<std::uint32_t>& value) { value = from.row.whole_number(from.key); }
void read_json(const JsonPlace& from, std::string_view& value) { value = from.row.text(from.key); }
void read_json(const JsonPlace& from, std::string& value) { value = from.row.text(from.key); }
void read_json(const JsonPlace& from, bool& value) { value = from.row.boolean(from.key); }
void read_json(const JsonPlace& from, std::optional<double>& value) { value = from.row.number(from.key); }
template <typename Word>
    requires std::is_enum_v<Word>
void read_json(const JsonPlace& from, std::optional<Word>& value) {
    value = value_of_word<Word>(from.row.text(from.key), from.row.place_of(from.key));
}
void read_json(const JsonPlace& from, std::optional<NearestPoints>& value) {
    const std::string place = from.row.place_of(from.key);
    const auto& points = json_array(from.row.required(from.key), place);
    if (points.size() != 2) from.row.refuse_key(from.key, "not two points");
    value = {json_point(points[0], place), json_point(points[1], place)};
}
void read_json(const JsonPlace& from, std::optional<std::vector<Contact>>& value) {
    const std::string place = from.row.place_of(from.key);
    value.emplace();
    for (const auto& contact : json_array(from.row.required(from.key), place)) {
        value->push_back(contact_of(contact, place));
    }
}

}  // namespace

std::string json_line(const CollisionRecord& row) {
    std::string line = "{";
    for_each_json_column(row, [&](std::string_view name, const auto& value) {
        const std::string text = as_json(value);
        if (!text.empty()) line += fmt::format("{}\"{}\":{}", line.size() > 1 ? "," : "", name, text);
    });
    return line + '}';
}

CollisionRecord read_collision(const JsonFields& row) {
    CollisionRecord record;
    for_each_json_column(record, [&](std::string_view name, auto& value) {
        constexpr bool needed = std::is_same_v<decltype(value), std::uint32_t&>;
        const nlohmann::json* const found = row.find(name);
        if (needed || (found != nullptr && !found->is_null())) read_json({row, name}, value);
    });
    return record;
}

}  // namespace octopair::io
