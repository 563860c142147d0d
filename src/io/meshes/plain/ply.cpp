// parse_ply(): the polygon file format of Stanford.
//
// Vertices and faces are read, in any order. Other elements and properties are skipped.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/ply_header.hpp"

namespace octopair::io {

namespace {

/// Reads the values of a text file, one element per line.
class TextValues {
public:
    static constexpr bool binary = false;
    explicit TextValues(TextLines& lines) : lines_(lines) {}
    void begin_element() { lines_.need("an element"); }
    bool more() { return !lines_.rest().empty(); }
    void end_element() {
        if (surplus_ == 0 && more()) surplus_ = lines_.line_number();
    }
    void end(const FileContent& file) {
        if (surplus_ > 0)
            file.warn(fmt::format("line {} has more values than its element has properties; the rest of it is not read",
                                  surplus_));
        if (lines_.next())
            file.warn(fmt::format("from line {} on it is not read, because its header says that it ends before",
                                  lines_.line_number()));
    }
    double value(const PlyScalar& scalar) {
        if (scalar.kind == PlyScalar::Kind::real) return lines_.number("a number");
        return double(lines_.number("an integer"));
    }
    /// Skips a value, which may be any word.
    void skip(const PlyScalar&) {
        if (lines_.word().empty()) lines_.refuse_line("the line ends where a number should follow");
    }

private:
    TextLines& lines_;
    std::uint64_t surplus_ = 0;  // first line that is not read whole; 0: none
};

/// Reads the values of a binary file.
class BinaryValues {
public:
    static constexpr bool binary = true;
    BinaryValues(const FileContent& file, std::size_t begin, bool big) : file_(file), at_(begin), big_(big) {}
    void begin_element() {
        if (++elements_ % 4096 == 0) file_.checkpoint(at_);
    }
    static bool more() { return true; }
    static void end_element() {}
    void end(const FileContent& file) const {
        const std::string_view left = file.bytes.substr(at_);
        if (left.find_first_not_of("\r\n") == std::string_view::npos) return;
        file.warn(
            fmt::format("the last {} bytes are not read, because its header says that it ends before", left.size()));
    }
    double value(const PlyScalar& scalar) {
        const std::size_t begin = at_;
        skip(scalar);
        std::uint64_t bits = 0;
        for (unsigned i = 0; i < scalar.bytes; ++i) {
            const unsigned place = big_ ? scalar.bytes - 1 - i : i;
            bits |= std::uint64_t(std::uint8_t(file_.bytes[begin + i])) << (8 * place);
        }
        return value_of(bits, scalar);
    }
    void skip(const PlyScalar& scalar) {
        if (file_.bytes.size() - at_ < scalar.bytes) refuse(file_.path, "ends in the middle of its elements");
        at_ += scalar.bytes;
    }

private:
    static double value_of(std::uint64_t bits, const PlyScalar& scalar) {
        if (scalar.kind == PlyScalar::Kind::real) {
            return scalar.bytes == 4 ? double(std::bit_cast<float>(std::uint32_t(bits))) : std::bit_cast<double>(bits);
        }
        const unsigned unused = 64 - 8 * scalar.bytes;
        if (scalar.kind == PlyScalar::Kind::integer) return double(std::int64_t(bits << unused) >> unused);
        return double(bits);
    }

    const FileContent& file_;
    std::size_t at_;
    bool big_;
    std::uint64_t elements_ = 0;
};

/// Which property of an element is which coordinate, or the corners. All others are skipped.
struct Roles {
    std::array<std::size_t, 3> coordinates = {none, none, none};
    std::size_t corners = none;
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    Roles() = default;
    explicit Roles(const PlyElement& element) {
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const PlyProperty& property = element.properties[i];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (!property.count && property.name == std::string(1, "xyz"[axis])) coordinates[axis] = i;
            }
            if (property.count && (property.name == "vertex_indices" || property.name == "vertex_index")) corners = i;
        }
    }
    bool uses(std::size_t property) const {
        return property == corners || std::find(coordinates.begin(), coordinates.end(), property) != coordinates.end();
    }
};

template <typename Values>
class ElementReader {
public:
    ElementReader(const FileContent& file, Values& values) : file_(file), values_(values) {}

    void read_vertices(const PlyElement& element, PlainMesh& mesh) {
        const Roles roles(element);
        for (const std::size_t role : roles.coordinates) {
            if (role == Roles::none) refuse(file_.path, "its vertices have no x, y or z");
            const PlyScalar& scalar = element.properties[role].value;
            mesh.rounded |= Values::binary && scalar.kind == PlyScalar::Kind::real && scalar.bytes == 4;
        }
        for (std::uint64_t i = 0; i < element.count; ++i) {
            constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
            Point3d& place = mesh.vertices.emplace_back(Point3d{unknown, unknown, unknown});
            visit(element, roles, [&](std::size_t property, double value) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (roles.coordinates[axis] == property) place[axis] = value;
                }
            });
        }
    }

    void read_faces(const PlyElement& element, std::uint64_t vertices, PlainMesh& mesh) {
        const Roles roles(element);
        if (element.count == 0) return;
        if (roles.corners == Roles::none) refuse(file_.path, "its faces have no list vertex_indices");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const std::size_t visited = visit(element, roles, [&](std::size_t property, double value) {
                if (property != roles.corners) return;
                if (!(value >= 0 && value < double(vertices)) || value != std::floor(value)) {
                    refuse(file_.path,
                           fmt::format("face {} has the corner {}, but there are {} vertices", i, value, vertices));
                }
                mesh.corners.push_back(std::uint32_t(value));
            });
            if (visited <= roles.corners) refuse(file_.path, fmt::format("face {} ends before its corners", i));
            mesh.end_face();
        }
    }

    void skip(const PlyElement& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) visit(element, Roles(), [](std::size_t, double) {});
    }

private:
    /// Calls take(number of the property, value) for the values of an element that have a role. Returns the number of properties that the
    /// element has: lines of a text may end early, as some programs write them.
    template <typename Take>
    std::size_t visit(const PlyElement& element, const Roles& roles, const Take& take) {
        values_.begin_element();
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (!values_.more()) return i;
            const PlyProperty& property = element.properties[i];
            double count = 1;
            if (property.count) count = values_.value(*property.count);
            if (!(count >= 0 && count <= double(file_.bytes.size())))
                refuse(file_.path, "a list has an impossible length");
            const bool is_used = roles.uses(i);
            for (double k = 0; k < count; ++k) {
                if (is_used) {
                    take(i, values_.value(property.value));
                } else {
                    values_.skip(property.value);
                }
            }
        }
        values_.end_element();
        return element.properties.size();
    }

    const FileContent& file_;
    Values& values_;
};

/// Throws: Error{bad_input} if a face has a corner whose place is not known. Other vertices do not matter.
void check_corners(const FileContent& file, const PlainMesh& mesh) {
    for (const std::uint32_t corner : mesh.corners) {
        for (const double at : mesh.vertices[corner]) {
            if (!std::isfinite(at))
                refuse(file.path, fmt::format("vertex {} has a coordinate that is not finite", corner));
        }
    }
}

template <typename Values>
PlainMesh read_elements(const FileContent& file, const PlyHeader& header, Values values) {
    PlainMesh mesh;
    ElementReader<Values> reader(file, values);
    for (const PlyElement& element : header.elements) {
        const bool is_read = element.name == "vertex" || element.name == "face";
        if (element.properties.empty() && !is_read) continue;  // nothing, or an empty line
        // An element has at least one byte in a binary file, and a line in a text file.
        const std::uint64_t least =
            std::max<std::uint64_t>(1, header.encoding == PlyEncoding::text ? 2 : element.least_bytes());
        if (element.count > file.bytes.size() / least) {
            refuse(file.path, fmt::format("says that it has {} elements '{}', but it is too short for them",
                                          element.count, element.name));
        }
        if (element.name == "vertex") {
            reader.read_vertices(element, mesh);
        } else if (element.name == "face") {
            reader.read_faces(element, header.vertices(), mesh);
        } else {
            if (element.name == "tristrips")
                refuse(file.path, "has triangle strips, which octopair does not read; save it with faces");
            reader.skip(element);
        }
    }
    values.end(file);
    check_corners(file, mesh);
    return mesh;
}

}  // namespace

PlainMesh parse_ply(const FileContent& file) {
    TextLines lines(file);
    const PlyHeader header = read_ply_header(lines);
    if (header.encoding == PlyEncoding::text) return read_elements(file, header, TextValues(lines));
    return read_elements(file, header, BinaryValues(file, lines.offset(), header.encoding == PlyEncoding::big_endian));
}

}  // namespace octopair::io
