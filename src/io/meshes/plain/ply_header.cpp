#include "io/meshes/plain/ply_header.hpp"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

struct NamedScalar {
    std::string_view name, other_name;
    PlyScalar scalar;
};

PlyScalar scalar_of(TextLines& lines) {
    using Kind = PlyScalar::Kind;
    static constexpr NamedScalar scalars[] = {
        {"char", "int8", {1, Kind::integer}},   {"uchar", "uint8", {1, Kind::unsigned_integer}},
        {"short", "int16", {2, Kind::integer}}, {"ushort", "uint16", {2, Kind::unsigned_integer}},
        {"int", "int32", {4, Kind::integer}},   {"uint", "uint32", {4, Kind::unsigned_integer}},
        {"float", "float32", {4, Kind::real}},  {"double", "float64", {8, Kind::real}},
        {"int64", "int64", {8, Kind::integer}}, {"uint64", "uint64", {8, Kind::unsigned_integer}}};
    const std::string_view word = lines.word();
    for (const NamedScalar& named : scalars) {
        if (word == named.name || word == named.other_name) return named.scalar;
    }
    lines.refuse_line(
        fmt::format("a property has the type '{}', not one of PLY: char, uchar, short, ushort, int, uint, "
                    "float or double",
                    shown(word)));
}

void read_property(TextLines& lines, PlyHeader& header) {
    if (header.elements.empty()) lines.refuse_line("a property comes before the first element");
    PlyProperty property;
    if (lines.peek() == "list") {
        (void)lines.word();
        property.count = scalar_of(lines);
        if (property.count->kind == PlyScalar::Kind::real) lines.refuse_line("the length of a list is not an integer");
    }
    property.value = scalar_of(lines);
    property.name = lines.word();
    header.elements.back().properties.push_back(std::move(property));
}

PlyEncoding encoding_of(TextLines& lines) {
    const std::string_view word = lines.word();
    if (word == "ascii") return PlyEncoding::text;
    if (word == "binary_little_endian") return PlyEncoding::little_endian;
    if (word == "binary_big_endian") return PlyEncoding::big_endian;
    lines.refuse_line(
        fmt::format("the format is '{}', not ascii, binary_little_endian or binary_big_endian", shown(word)));
}

}  // namespace

PlyHeader read_ply_header(TextLines& lines) {
    lines.require_line("'ply'");
    if (lines.peek() != "ply")
        lines.refuse_line(fmt::format("a PLY file begins with 'ply', not '{}'", shown(lines.peek())));
    (void)lines.word();
    PlyHeader header;
    for (;;) {
        lines.require_line("the rest of the header");
        const std::string_view word = lines.word();
        if (word == "end_header") return header;
        if (word == "format") {
            header.encoding = encoding_of(lines);
        } else if (word == "element") {
            PlyElement& element = header.elements.emplace_back();
            element.name = lines.word();
            element.count = lines.integer("the number of elements", 0xFFFFFFFF);
        } else if (word == "property") {
            read_property(lines, header);
        }  // All other lines are comments, or have no meaning for octopair.
    }
}

}  // namespace octopair::io
