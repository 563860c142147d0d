// Writes the geometry nodes of X3D files.
#include "io/meshes/assimp/content/xml_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

using namespace std::string_view_literals;

/// Corners of faces, as indices of points. Each face ends with -1.
using CornerList = std::vector<double>;

void write_list(std::string_view name, const std::vector<double>& numbers, XmlWriter& out) {
    out.attribute(name, list_text(numbers));
}

/// Writes an IndexedFaceSet with its points.
void write_faces(const CornerList& corners, const std::vector<double>& points, XmlWriter& out) {
    out.open("IndexedFaceSet");
    write_list("coordIndex", corners, out);
    out.open("Coordinate");
    write_list("point", points, out);
    out.close();
    out.close();
}

/// Returns the coordinates of all points of a geometry node, three for each point.
std::vector<double> points_of(const XmlElement& node, const X3dResolve& resolve) {
    for (const XmlElement& child : node.children()) {
        if (child.name() != "Coordinate" && child.name() != "CoordinateDouble") continue;
        const XmlElement coordinate = resolve(child);
        std::vector<double> points = x3d_numbers(coordinate, "point");
        if (points.size() % 3 != 0)
            coordinate.refuse(fmt::format("point has {} numbers, which is no multiple of 3", points.size()));
        return points;
    }
    if (node.children().empty()) return {};
    for (const XmlElement& child : node.children()) {
        if (child.name().find("Coordinate") != std::string_view::npos && !child.name().starts_with("Texture"))
            node.refuse(
                fmt::format("has its points in a {}, which octopair does not read; export a Coordinate", child.name()));
    }
    return {};
}

/// Returns a list of corners without empty faces, and with -1 after the last face.
CornerList faces_of(const XmlElement& node, std::string_view name) {
    CornerList corners;
    for (const double index : x3d_numbers(node, name)) {
        if (index >= 0 || (!corners.empty() && corners.back() != -1)) corners.push_back(index < 0 ? -1 : index);
    }
    if (!corners.empty() && corners.back() != -1) corners.push_back(-1);
    return corners;
}

void check_corners(const XmlElement& node, std::string_view name, const CornerList& corners, std::size_t points) {
    for (const double index : corners) {
        if (index == -1 || (index >= 0 && index < double(points) && index == std::floor(index))) continue;
        node.refuse(fmt::format("{} has the index {}, but there are {} points", name, number_text(index), points));
    }
}

/// Calls visit(first, count) for each run of points. `counts` has the lengths of the runs; without counts, all points are one run.
template <typename Visit>
void for_each_run(const XmlElement& node, std::string_view counts, std::size_t points, const Visit& visit) {
    std::size_t first = 0;
    for (const double count : x3d_numbers(node, counts)) {
        if (!(count >= 0) || double(first) + count > double(points))
            node.refuse(fmt::format("{} needs more than {} points", counts, points));
        visit(first, std::size_t(count));
        first += std::size_t(count);
    }
}

/// Appends the triangles of a strip, or of a fan, of corners.
void append_triangles(const std::vector<double>& corners, bool fan, CornerList& faces) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
        const double first = fan ? corners[0] : corners[k - 2];
        const bool swap = !fan && k % 2 == 1;
        const double second = swap ? corners[k] : corners[k - 1], third = swap ? corners[k - 1] : corners[k];
        faces.insert(faces.end(), {first, second, third, -1});
    }
}

/// Returns the runs of corners in a list, in which -1 separates runs.
std::vector<std::vector<double>> runs_of(const CornerList& corners) {
    std::vector<std::vector<double>> runs(1);
    for (const double index : corners) {
        if (index >= 0) {
            runs.back().push_back(index);
        } else {
            runs.emplace_back();
        }
    }
    return runs;
}

std::vector<double> ascending(std::size_t first, std::size_t count) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(double(first + i));
    return numbers;
}

/// Divides the corners into faces of `size` corners, and appends these faces.
void append_faces(const std::vector<double>& corners, std::size_t size, CornerList& faces) {
    for (std::size_t k = 0; k + size <= corners.size(); k += size) {
        faces.insert(faces.end(), corners.begin() + std::ptrdiff_t(k), corners.begin() + std::ptrdiff_t(k + size));
        faces.push_back(-1);
    }
}

/// Returns the faces of a set, as corners of an IndexedFaceSet; nothing for other types.
std::optional<CornerList> set_faces(const XmlElement& node, std::size_t points) {
    const std::string_view type = node.name();
    CornerList faces;
    if (type == "IndexedFaceSet") return faces_of(node, "coordIndex");
    if (type == "IndexedTriangleStripSet" || type == "IndexedTriangleFanSet") {
        for (const auto& run : runs_of(faces_of(node, "index")))
            append_triangles(run, type == "IndexedTriangleFanSet", faces);
    } else if (type == "IndexedTriangleSet" || type == "IndexedQuadSet") {
        const std::vector<double> corners = x3d_numbers(node, "index");
        if (std::any_of(corners.begin(), corners.end(), [](double index) { return index < 0; }))
            node.refuse("index has a negative index");
        append_faces(corners, type == "IndexedQuadSet" ? 4 : 3, faces);
    } else if (type == "TriangleStripSet" || type == "TriangleFanSet") {
        const bool fan = type == "TriangleFanSet";
        for_each_run(node, fan ? "fanCount" : "stripCount", points, [&](std::size_t first, std::size_t count) {
            append_triangles(ascending(first, count), fan, faces);
        });
    } else if (type == "TriangleSet" || type == "QuadSet") {
        append_faces(ascending(0, points), type == "QuadSet" ? 4 : 3, faces);
    } else {
        return std::nullopt;
    }
    return faces;
}

bool write_set(const XmlElement& node, const X3dResolve& resolve, XmlWriter& out) {
    constexpr std::array sets = {"IndexedFaceSet"sv,        "IndexedTriangleSet"sv, "IndexedTriangleStripSet"sv,
                                 "IndexedTriangleFanSet"sv, "IndexedQuadSet"sv,     "TriangleSet"sv,
                                 "TriangleStripSet"sv,      "TriangleFanSet"sv,     "QuadSet"sv};
    if (std::find(sets.begin(), sets.end(), node.name()) == sets.end()) return false;
    const std::vector<double> points = points_of(node, resolve);
    const auto faces = set_faces(node, points.size() / 3);
    check_corners(node, node.name() == "IndexedFaceSet" ? "coordIndex" : "index", *faces, points.size() / 3);
    if (!faces->empty()) write_faces(*faces, points, out);
    return true;
}

/// Writes lines and points. A line becomes a face with two corners.
bool write_lines(const XmlElement& node, const X3dResolve& resolve, XmlWriter& out) {
    if (node.name() != "IndexedLineSet" && node.name() != "LineSet" && node.name() != "PointSet") return false;
    const std::vector<double> points = points_of(node, resolve);
    CornerList faces;
    const auto append_line = [&](const std::vector<double>& run) {
        for (std::size_t k = 1; k < run.size(); ++k) faces.insert(faces.end(), {run[k - 1], run[k], -1});
    };
    if (node.name() == "IndexedLineSet") {
        const CornerList corners = faces_of(node, "coordIndex");
        check_corners(node, "coordIndex", corners, points.size() / 3);
        for (const auto& run : runs_of(corners)) append_line(run);
    } else if (node.name() == "LineSet") {
        for_each_run(node, "vertexCount", points.size() / 3,
                     [&](std::size_t first, std::size_t count) { append_line(ascending(first, count)); });
    } else {
        append_faces(ascending(0, points.size() / 3), 1, faces);
    }
    if (!faces.empty()) write_faces(faces, points, out);
    return true;
}

/// Returns the only number of an attribute.
double number_or(const XmlElement& node, std::string_view name, double otherwise) {
    const std::vector<double> numbers = x3d_numbers(node, name);
    if (!node.attribute(name)) return otherwise;
    if (numbers.size() != 1) node.refuse(fmt::format("{} has {} numbers in place of one", name, numbers.size()));
    return numbers[0];
}

bool flag_or(const XmlElement& node, std::string_view name, bool otherwise) {
    const auto text = node.attribute(name);
    return text ? text->starts_with('t') || text->starts_with('T') || text->starts_with('1') : otherwise;
}

/// Number of sides of a round shape. A multiple of 4, so that the bounds of the written shape are those of the round shape.
constexpr std::size_t round_sides = 32;

/// Appends the points of a circle at the height y.
void append_circle(double radius, double y, std::vector<double>& points) {
    for (std::size_t k = 0; k < round_sides; ++k) {
        const double angle = 2 * std::numbers::pi * double(k) / double(round_sides);
        points.insert(points.end(), {radius * std::cos(angle), y, radius * std::sin(angle)});
    }
}

/// Appends a face with the points of a circle. `first`: index of the first of these points.
void append_disk(std::size_t first, CornerList& faces) {
    const std::vector<double> corners = ascending(first, round_sides);
    faces.insert(faces.end(), corners.begin(), corners.end());
    faces.push_back(-1);
}

/// Writes a cone as a pyramid. Its tip is at the top, along +y.
void write_cone(const XmlElement& node, XmlWriter& out) {
    const double height = number_or(node, "height", 2), radius = number_or(node, "bottomRadius", 1);
    std::vector<double> points = {0, height / 2, 0};
    append_circle(radius, -height / 2, points);
    CornerList faces;
    for (std::size_t k = 0; k < round_sides && flag_or(node, "side", true); ++k)
        faces.insert(faces.end(), {0, double((k + 1) % round_sides + 1), double(k + 1), -1});
    if (flag_or(node, "bottom", true)) append_disk(1, faces);
    if (!faces.empty()) write_faces(faces, points, out);
}

/// Writes a cylinder as a prism.
void write_cylinder(const XmlElement& node, XmlWriter& out) {
    const double height = number_or(node, "height", 2), radius = number_or(node, "radius", 1);
    std::vector<double> points;
    append_circle(radius, -height / 2, points);
    append_circle(radius, height / 2, points);
    CornerList faces;
    for (std::size_t k = 0; k < round_sides && flag_or(node, "side", true); ++k) {
        const auto a = double(k), b = double((k + 1) % round_sides), above = double(round_sides);
        faces.insert(faces.end(), {a, a + above, b + above, b, -1});
    }
    if (flag_or(node, "bottom", true)) append_disk(0, faces);
    if (flag_or(node, "top", true)) append_disk(round_sides, faces);
    if (!faces.empty()) write_faces(faces, points, out);
}

void write_grid(const XmlElement& node, XmlWriter& out) {
    const double columns = number_or(node, "xDimension", 0), rows = number_or(node, "zDimension", 0);
    const double x = number_or(node, "xSpacing", 1), z = number_or(node, "zSpacing", 1);
    const std::vector<double> heights = x3d_numbers(node, "height");
    if (!(columns >= 0 && rows >= 0) || columns * rows != double(heights.size()))
        node.refuse(fmt::format("has {} heights in place of {} times {}", heights.size(), columns, rows));
    std::vector<double> points;
    CornerList faces;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const auto width = std::size_t(columns);
        const std::size_t in_row = i % width, row_number = i / width;
        const auto column = double(in_row), row = double(row_number);
        points.insert(points.end(), {x * column, heights[i], z * row});
        if (column + 1 < columns && row + 1 < rows) {
            const auto at = double(i);
            faces.insert(faces.end(), {at, at + columns, at + columns + 1, at + 1, -1});
        }
    }
    if (!faces.empty()) write_faces(faces, points, out);
}

/// Writes an Extrusion. Refuses an Extrusion that Assimp would read wrongly.
void write_extrusion(const XmlElement& node, XmlWriter& out) {
    const std::vector<double> spine = x3d_numbers(node, "spine"), turns = x3d_numbers(node, "orientation");
    for (std::size_t k = 3; k < turns.size(); k += 4) {
        if (turns[k] != 0)
            node.refuse("an Extrusion with orientations is read wrongly; export it as an IndexedFaceSet");
    }
    const std::size_t points = spine.size() / 3;
    const auto step = [&](std::size_t k, std::size_t axis) { return spine[3 * k + axis] - spine[axis]; };
    bool straight = true, upward = true;
    for (std::size_t k = 1; k < points; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t next = (axis + 1) % 3;
            straight &= step(k, axis) * step(1, next) == step(k, next) * step(1, axis);
        }
        upward &= step(k, 0) == 0 && step(k, 2) == 0 && spine[3 * k + 1] > spine[3 * k - 2];
    }
    if (straight && !upward)
        node.refuse("an Extrusion along a straight spine other than y is read wrongly; export it as an IndexedFaceSet");
    const std::size_t scales = x3d_numbers(node, "scale").size() / 2, needed = points == 0 ? 2 : points;
    if (scales > 1 && scales != needed) node.refuse(fmt::format("has {} scales for {} points", scales, needed));
    out.open("Extrusion");
    for (const std::string_view name : {"crossSection"sv, "scale"sv, "spine"sv}) {
        if (node.attribute(name)) write_list(name, x3d_numbers(node, name), out);
    }
    for (const std::string_view name : {"beginCap"sv, "endCap"sv})
        out.attribute(name, flag_or(node, name, true) ? "true" : "false");
    out.close();
}

/// A type that Assimp reads rightly, and its attributes with numbers.
struct PlainType {
    std::string_view name, numbers;
};

constexpr auto plain_types = std::to_array<PlainType>({
    {"Arc2D", "endAngle radius startAngle"},
    {"ArcClose2D", "endAngle radius startAngle"},
    {"Box", "size"},
    {"Circle2D", "radius"},
    {"Disk2D", "innerRadius outerRadius"},
    {"Polyline2D", "lineSegments"},
    {"Polypoint2D", "point"},
    {"Rectangle2D", "size"},
    {"Sphere", "radius"},
    {"TriangleSet2D", "vertices"},
});

bool write_plain(const XmlElement& node, XmlWriter& out) {
    const auto found = std::find_if(plain_types.begin(), plain_types.end(),
                                    [&](const PlainType& type) { return type.name == node.name(); });
    if (found == plain_types.end()) return false;
    out.open(node.name());
    std::string_view numbers = found->numbers;
    for (auto name = take_list_word(numbers); !name.empty(); name = take_list_word(numbers)) {
        if (node.attribute(name)) write_list(name, x3d_numbers(node, name), out);
    }
    if (const auto closure = node.attribute("closureType")) out.attribute("closureType", *closure);
    out.close();
    return true;
}

}  // namespace

std::vector<double> x3d_numbers(const XmlElement& node, std::string_view name) {
    NumberList list = numbers_of(node.attribute(name).value_or(""), ",");
    if (!list.wrong.empty()) node.refuse(fmt::format("{} has '{}', which is no number", name, shown(list.wrong)));
    return std::move(list.numbers);
}

void write_x3d_numbers(const XmlElement& node, std::string_view name, std::size_t count, XmlWriter& out) {
    if (!node.attribute(name)) return;
    const std::vector<double> numbers = x3d_numbers(node, name);
    if (numbers.size() != count)
        node.refuse(fmt::format("{} has {} numbers in place of {}", name, numbers.size(), count));
    write_list(name, numbers, out);
}

bool write_x3d_geometry(const XmlElement& node, const X3dResolve& resolve, XmlWriter& out) {
    if (write_set(node, resolve, out) || write_lines(node, resolve, out) || write_plain(node, out)) return true;
    if (node.name() == "Cone") {
        write_cone(node, out);
    } else if (node.name() == "Cylinder") {
        write_cylinder(node, out);
    } else if (node.name() == "ElevationGrid") {
        write_grid(node, out);
    } else if (node.name() == "Extrusion") {
        write_extrusion(node, out);
    } else {
        return false;
    }
    return true;
}

}  // namespace octopair::io
