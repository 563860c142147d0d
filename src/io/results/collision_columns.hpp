// CollisionRecord: one row of a collision result, and the columns that a row has in .jsonl and .csv. Every writer and every reader of
// rows uses these columns.
// Start here to add a new column of results.
//
// A column is a name and a member of CollisionRecord. The type of the member says how its value is written and read.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/failure.hpp"
#include "io/json/json_fields.hpp"
#include "io/object_details.hpp"
#include "io/results/collision_row.hpp"
#include "octopair/pipeline.hpp"

#include <fmt/format.h>

namespace octopair::io {

/// One object of a collision. The texts are borrowed.
struct RecordedObject {
    std::uint32_t number = 0;
    std::string_view name = {};                                     ///< empty if it has none
    std::string_view file = {};                                     ///< empty if the result has one input file
    std::array<std::string_view, all_details.size()> details = {};  ///< empty where unknown
    std::optional<std::uint32_t> triangle = {};                     ///< number within its owner
    bool open = false;
};

using NearestPoints = std::array<Point3d, 2>;

/// Content of a row. A value that the result does not know is empty.
struct CollisionRecord {
    RecordedObject a, b;
    std::string key = {};  ///< collision_key(); empty if it is unknown
    std::optional<Change> change = {};
    std::optional<Status> status = {};
    std::string_view comment = {};
    std::optional<CollisionClass> collision_class = {};
    std::optional<double> time = {}, distance = {};
    std::optional<NearestPoints> nearest = {};
    std::optional<double> depth = {};
    std::optional<DepthKind> depth_kind = {};
    std::optional<double> depth_at_most = {};
    std::optional<double> thickness = {};
    std::optional<ThicknessKind> thickness_kind = {};
    std::optional<std::vector<Contact>> contacts = {};
    bool more_contacts = false;
};

/// Returns row `i`. It borrows the texts of `form`.
CollisionRecord record_of(const CollisionRows& rows, std::size_t i, const CollisionForm& form);
/// Returns the collision of a row that was read. Values that the row does not have are 0.
Finding finding_of(const CollisionRecord& row);

/// Names of the columns of one object.
struct ObjectColumns {
    std::string_view number, name, file;
    std::array<std::string_view, all_details.size()> details;
    std::string_view triangle, open;
};
inline constexpr ObjectColumns columns_of_a = {
    "a",          "a_name", "a_file", {"a_label", "a_type", "a_id", "a_parent", "a_level", "a_material"},
    "a_triangle", "a_open"};
inline constexpr ObjectColumns columns_of_b = {
    "b",          "b_name", "b_file", {"b_label", "b_type", "b_id", "b_parent", "b_level", "b_material"},
    "b_triangle", "b_open"};

/// Calls visit(name, value) for each column of .jsonl, in their order. `Row` is CollisionRecord, or const.
template <typename Row, typename Visit>
void for_each_json_column(Row& row, const Visit& visit) {
    const auto visit_object = [&](const ObjectColumns& columns, auto& object) {
        visit(columns.name, object.name);
        visit(columns.file, object.file);
        for (std::size_t i = 0; i < all_details.size(); ++i) visit(columns.details[i], object.details[i]);
        visit(columns.triangle, object.triangle);
    };
    visit(columns_of_a.number, row.a.number);
    visit(columns_of_b.number, row.b.number);
    visit_object(columns_of_a, row.a);
    visit_object(columns_of_b, row.b);
    visit("key", row.key);
    visit("status", row.status);
    visit("comment", row.comment);
    visit("change", row.change);
    visit("class", row.collision_class);
    visit("time", row.time);
    visit("distance", row.distance);
    visit("nearest", row.nearest);
    visit("depth", row.depth);
    visit("depth_kind", row.depth_kind);
    visit("depth_at_most", row.depth_at_most);
    visit("thickness", row.thickness);
    visit("thickness_kind", row.thickness_kind);
    visit("contacts", row.contacts);
    visit("more_contacts", row.more_contacts);
    visit(columns_of_a.open, row.a.open);
    visit(columns_of_b.open, row.b.open);
}

// Values that only .csv has: a field of .csv cannot hold a list, so each value is one part of a list in the row. Borrowed.
template <typename Row>
struct CsvContactCount {
    Row& row;
};
/// The points of the contacts. For objects that are apart: the nearest points.
template <typename Row>
struct CsvPoints {
    Row& row;
};
/// Names the objects that are open meshes: "a", "b", "ab" or nothing.
template <typename Row>
struct CsvOpen {
    Row& row;
};

/// Calls visit(name, value) for each column that .csv may have, in their order. `Row` is CollisionRecord, or const.
template <typename Row, typename Visit>
void for_each_csv_column(Row& row, const Visit& visit) {
    visit(columns_of_a.number, row.a.number);
    visit(columns_of_b.number, row.b.number);
    visit(columns_of_a.name, row.a.name);
    visit(columns_of_b.name, row.b.name);
    visit("class", row.collision_class);
    visit("distance", row.distance);
    visit("depth", row.depth);
    visit("time", row.time);
    visit("contacts", CsvContactCount<Row>{row});
    visit("points", CsvPoints<Row>{row});
    visit("more_contacts", row.more_contacts);
    visit("depth_kind", row.depth_kind);
    visit("open", CsvOpen<Row>{row});
    visit("thickness", row.thickness);
    visit("thickness_kind", row.thickness_kind);
    for (std::size_t i = 0; i < all_details.size(); ++i) {
        visit(columns_of_a.details[i], row.a.details[i]);
        visit(columns_of_b.details[i], row.b.details[i]);
    }
    visit(columns_of_a.file, row.a.file);
    visit(columns_of_b.file, row.b.file);
    visit("key", row.key);
    visit("status", row.status);
    visit("comment", row.comment);
    visit("change", row.change);
}

/// Returns the row as a JSON object.
std::string json_line(const CollisionRecord& row);
/// Returns the fields of a row, quoted if needed. `shown`: for each column of for_each_csv_column(), true if the file has the column.
std::string csv_line(const CollisionRecord& row, const std::vector<bool>& shown);
/// Returns `text` as a field of a .csv file, quoted if needed (RFC 4180). Invalid UTF-8 becomes U+FFFD.
std::string csv_field(std::string_view text);

/// Reads a row. Ignores keys that are no columns: the caller handles them. The record borrows the texts of the JSON object.
/// Throws: Error{bad_input} if `a` or `b` is missing, or if a column has a value that its type cannot have.
CollisionRecord read_collision(const JsonFields& row);

/// Returns the field of a column, without quotes; empty if the row has none.
using CsvFieldOf = std::function<std::string_view(std::string_view name)>;
/// Reads a row of a table. The record borrows the fields. `place` is the beginning of messages. Throws: as read_collision().
CollisionRecord read_csv_collision(const CsvFieldOf& field, const std::string& place);

/// Number of words of the values of a type.
template <typename Word>
inline constexpr std::size_t words_of = 0;
template <>
inline constexpr std::size_t words_of<CollisionClass> = collision_classes;
template <>
inline constexpr std::size_t words_of<DepthKind> = 3;
template <>
inline constexpr std::size_t words_of<ThicknessKind> = 4;
template <>
inline constexpr std::size_t words_of<Change> = 3;
template <>
inline constexpr std::size_t words_of<Status> = status_values;

/// Returns the value whose word (word_of()) is `text`. Throws: Error{bad_input} that begins with `place` and names all words.
template <typename Word>
Word value_of_word(std::string_view text, const std::string& place) {
    std::string known;
    for (std::size_t i = 0; i < words_of<Word>; ++i) {
        if (word_of(Word(i)) == text) return Word(i);
        known += fmt::format("{}{}", i == 0 ? "" : ", ", word_of(Word(i)));
    }
    refuse(place, fmt::format("'{}' is none of {}", shown_text(text), known));
}

}  // namespace octopair::io
