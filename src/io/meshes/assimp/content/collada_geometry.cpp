// Writes the meshes of COLLADA files.
#include "io/meshes/assimp/content/xml_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;

constexpr std::array primitive_names = {"lines"sv,     "linestrips"sv, "polygons"sv, "polylist"sv,
                                        "triangles"sv, "trifans"sv,    "tristrips"sv};

bool is_primitive_group(const XmlElement& element) {
    return std::find(primitive_names.begin(), primitive_names.end(), element.name()) != primitive_names.end();
}

/// Returns a whole number of an attribute.
std::size_t whole_or(const XmlElement& element, std::string_view name, std::size_t otherwise) {
    const auto text = element.attribute(name);
    if (!text) return otherwise;
    std::string_view rest = *text;
    const auto number = number_of_word(take_list_word(rest));
    if (!number || !(*number >= 0) || *number > 1e15 || *number != std::floor(*number))
        element.refuse(fmt::format("{}=\"{}\" is no whole number", name, shown(*text)));
    return std::size_t(*number);
}

/// Returns the element of a mesh that a reference such as "#id" names.
XmlElement referred(const XmlElement& from, const XmlElement& mesh) {
    const std::string_view source = from.attribute("source").value_or("");
    for (const XmlElement& child : mesh.children()) {
        if (source.size() > 1 && source.starts_with('#') && child.attribute("id") == source.substr(1)) return child;
    }
    from.refuse(fmt::format("source=\"{}\" is not in the same mesh", shown(source)));
}

std::optional<XmlElement> input_with(const XmlElement& element, std::string_view semantic) {
    for (const XmlElement& input : element.children("input")) {
        if (input.attribute("semantic") == semantic) return input;
    }
    return std::nullopt;
}

/// Returns the places of x, y and z among the values of an accessor: the params named X, Y and Z, or else the first three with any name.
std::array<std::size_t, 3> places_of(const XmlElement& accessor) {
    std::array<std::size_t, 3> named{}, first{};
    std::size_t found = 0, params = 0, position = 0;
    for (const XmlElement& param : accessor.children("param")) {
        const std::string_view name = param.attribute("name").value_or("");
        const std::size_t axis = std::string_view("XYZ").find(name);
        if (name.size() == 1 && axis < 3) named[axis] = position, ++found;
        if (!name.empty() && params < 3) first[params++] = position;
        ++position;
    }
    if (found == 3) return named;
    if (params < 3) accessor.refuse("positions need three params with names");
    return first;
}

/// Returns the positions of a <source>, three numbers each.
std::vector<double> positions_of(const XmlElement& source) {
    const auto common = source.child("technique_common");
    const auto accessor = common ? common->child("accessor") : std::nullopt;
    if (!accessor) source.refuse("has no accessor");
    const std::string_view url = accessor->attribute("source").value_or("");
    std::vector<double> values;
    bool found = false;
    for (const XmlElement& child : source.children()) {
        if ((child.name() != "float_array" && child.name() != "int_array") || url.empty()) continue;
        if (child.attribute("id") != url.substr(1)) continue;
        values = collada_numbers(child);
        found = true;
    }
    if (!found) accessor->refuse(fmt::format("source=\"{}\" is not in the same <source>", shown(url)));
    const auto places = places_of(*accessor);
    const std::size_t count = whole_or(*accessor, "count", 0), offset = whole_or(*accessor, "offset", 0);
    const std::size_t stride = whole_or(*accessor, "stride", 1);
    const std::size_t last = *std::max_element(places.begin(), places.end());
    if (count > 0 && (stride <= last || offset + (count - 1) * stride + last >= values.size()))
        accessor->refuse(
            fmt::format("{} positions with a stride of {} do not fit to {} values", count, stride, values.size()));
    std::vector<double> positions;
    for (std::size_t i = 0; i < count; ++i) {
        for (const std::size_t place : places) positions.push_back(values[offset + i * stride + place]);
    }
    return positions;
}

/// Faces or lines of a group of primitives: the number of corners of each, and all corners as indices of positions.
struct Primitives {
    std::vector<double> sizes, corners;

    void add(std::initializer_list<double> face) {
        sizes.push_back(double(face.size()));
        corners.insert(corners.end(), face);
    }
};

/// Returns the indices of positions in a <p>, one index for each corner.
std::vector<double> corners_of(const XmlElement& p, std::size_t stride, std::size_t offset, std::size_t positions) {
    const std::vector<double> indices = collada_numbers(p);
    if (indices.size() % stride != 0)
        p.refuse(fmt::format("<p> has {} indices, which is no multiple of {}", indices.size(), stride));
    std::vector<double> corners;
    for (std::size_t k = offset; k < indices.size(); k += stride) {
        const double index = indices[k];
        if (!(index >= 0 && index < double(positions)) || index != std::floor(index))
            p.refuse(fmt::format("<p> has the index {}, but there are {} positions", number_text(index), positions));
        corners.push_back(index);
    }
    return corners;
}

/// Appends the primitives of a <p> that has one strip, fan or polygon.
void add_run(std::string_view group, const std::vector<double>& run, Primitives& primitives) {
    if (group == "polygons" && !run.empty()) {
        primitives.sizes.push_back(double(run.size()));
        primitives.corners.insert(primitives.corners.end(), run.begin(), run.end());
    } else if (group == "linestrips") {
        for (std::size_t k = 1; k < run.size(); ++k) primitives.add({run[k - 1], run[k]});
    } else if (group == "trifans") {
        for (std::size_t k = 2; k < run.size(); ++k) primitives.add({run[0], run[k - 1], run[k]});
    } else if (group == "tristrips") {
        for (std::size_t k = 2; k < run.size(); ++k) {
            const bool swap = k % 2 == 1;
            primitives.add({run[k - 2], swap ? run[k] : run[k - 1], swap ? run[k - 1] : run[k]});
        }
    }
}

/// Appends the primitives of a <p> that has many primitives.
void add_many(const XmlElement& group, const XmlElement& p, const std::vector<double>& corners,
              Primitives& primitives) {
    std::vector<double> sizes;
    double sum = 0;
    if (group.name() == "polylist") {
        const auto counts = group.child("vcount");
        if (counts) sizes = collada_numbers(*counts);
        for (const double size : sizes) sum += size;
    } else {
        const std::size_t size = group.name() == "lines" ? 2 : 3;
        sizes.assign(corners.size() / size, double(size));
        sum = double(sizes.size() * size);
    }
    if (sum != double(corners.size()))
        p.refuse(fmt::format("<p> has {} corners, but <{}> needs {}", corners.size(), group.name(), number_text(sum)));
    primitives.sizes.insert(primitives.sizes.end(), sizes.begin(), sizes.end());
    primitives.corners.insert(primitives.corners.end(), corners.begin(), corners.end());
}

/// Returns the place of the position's index among the indices of a corner, and the number of indices of a corner.
std::pair<std::size_t, std::size_t> offset_and_stride(const XmlElement& group, const XmlElement& input) {
    std::size_t stride = 1;
    for (const XmlElement& other : group.children("input")) stride = std::max(stride, whole_or(other, "offset", 0) + 1);
    return {whole_or(input, "offset", 0), stride};
}

Primitives primitives_of(const XmlElement& group, const XmlElement& input, std::size_t positions) {
    const auto [offset, stride] = offset_and_stride(group, input);
    Primitives primitives;
    for (const XmlElement& p : group.children()) {
        if (p.name() == "ph") p.refuse("a polygon with holes is not read; triangulate the model before the export");
        if (p.name() != "p") continue;
        const std::vector<double> corners = corners_of(p, stride, offset, positions);
        if (group.name() == "triangles" || group.name() == "lines" || group.name() == "polylist") {
            add_many(group, p, corners, primitives);
        } else {
            add_run(group.name(), corners, primitives);
        }
    }
    return primitives;
}

void write_source(std::string_view id, const std::vector<double>& positions, XmlWriter& out) {
    const std::string array = fmt::format("{}-array", id), count = fmt::format("{}", positions.size() / 3);
    out.open("source");
    out.attribute("id", id);
    out.open("float_array");
    out.attribute("id", array);
    out.attribute("count", fmt::format("{}", positions.size()));
    out.text(list_text(positions));
    out.close();
    out.open("technique_common");
    out.open("accessor");
    out.attribute("source", "#" + array);
    out.attribute("count", count);
    out.attribute("stride", "3");
    for (const std::string_view axis : {"X"sv, "Y"sv, "Z"sv}) {
        out.open("param");
        out.attribute("name", axis);
        out.attribute("type", "float");
        out.close();
    }
    out.close();
    out.close();
    out.close();
}

void write_input(std::string_view semantic, std::string_view source, bool with_offset, XmlWriter& out) {
    out.open("input");
    out.attribute("semantic", semantic);
    out.attribute("source", source);
    if (with_offset) out.attribute("offset", "0");
    out.close();
}

void write_group(const XmlElement& group, const Primitives& primitives, XmlWriter& out) {
    const bool lines = group.name() == "lines" || group.name() == "linestrips";
    out.open(lines ? "lines" : "polylist");
    if (const auto material = group.attribute("material")) out.attribute("material", *material);
    out.attribute("count", fmt::format("{}", primitives.sizes.size()));
    write_input("VERTEX", "#octopair.vertices", true, out);
    if (!lines) {
        out.open("vcount");
        out.text(list_text(primitives.sizes));
        out.close();
    }
    out.open("p");
    out.text(list_text(primitives.corners));
    out.close();
    out.close();
}

/// Returns the <source> with the positions of a group of primitives, and the input that refers to this source.
std::pair<XmlElement, XmlElement> position_source(const XmlElement& group, const XmlElement& mesh) {
    if (const auto input = input_with(group, "VERTEX")) {
        const XmlElement vertices = referred(*input, mesh);
        const auto position = input_with(vertices, "POSITION");
        if (!position) vertices.refuse("has no input with the semantic POSITION");
        return {referred(*position, mesh), *input};
    }
    const auto position = input_with(group, "POSITION");
    if (!position) group.refuse("has no input with the semantic VERTEX");
    return {referred(*position, mesh), *position};
}

}  // namespace

std::vector<double> collada_numbers(const XmlElement& element, std::size_t count) {
    NumberList list = numbers_with_commas_of(element.text());
    if (!list.wrong.empty())
        element.refuse(fmt::format("<{}> has '{}', which is no number", element.name(), shown(list.wrong)));
    if (count > 0 && list.numbers.size() != count)
        element.refuse(fmt::format("<{}> has {} numbers in place of {}", element.name(), list.numbers.size(), count));
    return std::move(list.numbers);
}

std::size_t count_primitive_groups(const XmlElement& mesh) {
    const std::vector<XmlElement> children = mesh.children();
    return std::size_t(std::count_if(children.begin(), children.end(), [](const XmlElement& child) {
        return is_primitive_group(child) && child.contains("p");
    }));
}

void write_collada_mesh(const XmlElement& mesh, XmlWriter& out) {
    std::optional<std::size_t> source;  // the source of positions of all groups so far
    std::vector<double> positions;
    out.open("mesh");
    for (const XmlElement& group : mesh.children()) {
        if (!is_primitive_group(group) || (!group.contains("p") && !group.contains("ph"))) continue;
        const auto [next, input] = position_source(group, mesh);
        if (source && *source != next.index())
            group.refuse("the primitives of a mesh have positions of several sources");
        if (!source) {
            source = next.index();
            positions = positions_of(next);
            write_source("octopair.positions", positions, out);
            out.open("vertices");
            out.attribute("id", "octopair.vertices");
            write_input("POSITION", "#octopair.positions", false, out);
            out.close();
        }
        const Primitives primitives = primitives_of(group, input, positions.size() / 3);
        if (!primitives.sizes.empty()) write_group(group, primitives, out);
    }
    out.close();
}

}  // namespace octopair::io
