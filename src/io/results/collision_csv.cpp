// Rows of collisions as fields of a table. as_csv() returns a value of a column as a field; read_csv() reads such a field.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"

namespace octopair::io {

std::string csv_field(std::string_view text) {
    std::string clean = clean_text(text);
    if (clean.find_first_of(",\"\r\n") == std::string::npos) return clean;
    std::string quoted = "\"";
    for (const char c : clean) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

namespace {

std::string as_csv(std::uint32_t value) { return std::to_string(value); }
std::string as_csv(std::string_view value) { return csv_field(value); }
std::string as_csv(bool value) { return value ? "true" : ""; }
std::string as_csv(const std::optional<double>& value) { return value ? json_number(*value) : ""; }
template <typename Word>
    requires std::is_enum_v<Word>
std::string as_csv(const std::optional<Word>& value) {
    return value ? std::string(word_of(*value)) : "";
}
std::string as_csv(CsvContactCount<const CollisionRecord> value) {
    return value.row.contacts ? std::to_string(value.row.contacts->size()) : "";
}
std::string as_csv(CsvPoints<const CollisionRecord> value) {
    std::string text;
    const auto add = [&](const Point3d& point) {
        text += fmt::format("{}{} {} {}", text.empty() ? "" : ";", json_number(point[0]), json_number(point[1]),
                            json_number(point[2]));
    };
    if (value.row.nearest) std::for_each(value.row.nearest->begin(), value.row.nearest->end(), add);
    if (value.row.contacts) {
        for (const Contact& contact : *value.row.contacts) add(contact.point);
    }
    return text;
}
std::string as_csv(CsvOpen<const CollisionRecord> value) {
    return std::string(value.row.a.open ? "a" : "") + (value.row.b.open ? "b" : "");
}

/// The text of a field, and its place in the file for messages.
struct CsvPlace {
    std::string_view text;
    std::string place;
};

[[noreturn]] void refuse_field(const CsvPlace& field, std::string_view wanted) {
    refuse(field.place, fmt::format("'{}' is not {}", shown_text(field.text), wanted));
}

/// Returns the value of a field that is one number. Refuses a field with anything else.
template <typename Number>
Number csv_number(const CsvPlace& field, std::string_view wanted) {
    Number value{};
    const char* const last = field.text.data() + field.text.size();
    const auto [end, error] = std::from_chars(field.text.data(), last, value);
    if (error != std::errc() || end != last || !std::isfinite(double(value))) refuse_field(field, wanted);
    return value;
}

/// Returns the points of a field "x y z;x y z".
std::vector<Point3d> points_in(const CsvPlace& field) {
    std::vector<Point3d> points;
    for (std::string_view rest = field.text; !rest.empty();) {
        const std::size_t end = std::min(rest.find(';'), rest.size());
        std::string_view numbers = rest.substr(0, end);
        Point3d& point = points.emplace_back();
        for (double& value : point) {
            numbers.remove_prefix(std::min(numbers.find_first_not_of(' '), numbers.size()));
            const auto [after, error] = std::from_chars(numbers.data(), numbers.data() + numbers.size(), value);
            if (error != std::errc() || !std::isfinite(value)) {
                refuse_field({rest.substr(0, end), field.place}, "three finite numbers");
            }
            numbers.remove_prefix(std::size_t(after - numbers.data()));
        }
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return points;
}

void read_csv(const CsvPlace& field, std::uint32_t& value) {
    value = csv_number<std::uint32_t>(field, "a whole number");
}
void read_csv(const CsvPlace& field, std::string_view& value) { value = field.text; }
void read_csv(const CsvPlace& field, std::string& value) { value = field.text; }
void read_csv(const CsvPlace& field, bool& value) { value = field.text == "true"; }
void read_csv(const CsvPlace& field, std::optional<double>& value) {
    value = csv_number<double>(field, "a finite number");
}
template <typename Word>
    requires std::is_enum_v<Word>
void read_csv(const CsvPlace& field, std::optional<Word>& value) {
    value = value_of_word<Word>(field.text, field.place);
}
void read_csv(const CsvPlace& field, CsvContactCount<CollisionRecord>) {
    (void)csv_number<std::uint32_t>(field, "a whole number");
}
void read_csv(const CsvPlace& field, CsvPoints<CollisionRecord> value) {
    const std::vector<Point3d> points = points_in(field);
    if (value.row.collision_class == CollisionClass::clearance && points.size() == 2) {
        value.row.nearest = {points[0], points[1]};
        return;
    }
    value.row.contacts.emplace();
    for (const Point3d& point : points) value.row.contacts->push_back({.point = point});
}
void read_csv(const CsvPlace& field, CsvOpen<CollisionRecord> value) {
    value.row.a.open = field.text.find('a') != std::string_view::npos;
    value.row.b.open = field.text.find('b') != std::string_view::npos;
}

}  // namespace

std::string csv_line(const CollisionRecord& row, const std::vector<bool>& shown) {
    std::string line;
    std::size_t column = 0;
    for_each_csv_column(row, [&](std::string_view, const auto& value) {
        if (!shown[column++]) return;
        if (column > 1) line += ',';
        line += as_csv(value);
    });
    return line;
}

CollisionRecord read_csv_collision(const CsvFieldOf& field, const std::string& place) {
    CollisionRecord record;
    for_each_csv_column(record, [&]<typename Value>(std::string_view name, Value&& value) {
        const CsvPlace found{field(name), fmt::format("{}: {}", place, name)};
        if (!found.text.empty() || std::is_same_v<Value, std::uint32_t&>) read_csv(found, value);
    });
    return record;
}

}  // namespace octopair::io
