// parse_ply(): the polygon file format of Stanford.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

enum class Encoding : std::uint8_t { text, little_endian, big_endian };

struct Scalar {
    unsigned bytes = 0;
    enum class Kind : std::uint8_t { integer, unsigned_integer, real } kind = Kind::integer;
};

struct Property {
    std::string name;
    Scalar value;
    std::optional<Scalar> count;  ///< type of the length, for a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    /// Returns the least number of bytes of one element, in a binary file.
    std::uint64_t least_bytes() const {
        std::uint64_t bytes = 0;
        for (const Property& property : properties)
            bytes += property.count ? property.count->bytes : property.value.bytes;
        return bytes;
    }
};

struct Header {
    Encoding encoding = Encoding::text;
    std::vector<Element> elements;
};

struct NamedScalar {
    std::string_view name, other_name;
    Scalar scalar;
};

Scalar scalar_of(TextLines& lines) {
    using Kind = Scalar::Kind;
    static constexpr NamedScalar scalars[] = {
        {"char", "int8", {1, Kind::integer}},   {"uchar", "uint8", {1, Kind::unsigned_integer}},
        {"short", "int16", {2, Kind::integer}}, {"ushort", "uint16", {2, Kind::unsigned_integer}},
        {"int", "int32", {4, Kind::integer}},   {"uint", "uint32", {4, Kind::unsigned_integer}},
        {"float", "float32", {4, Kind::real}},  {"double", "float64", {8, Kind::real}}};
    const std::string_view word = lines.word();
    for (const NamedScalar& named : scalars) {
        if (word == named.name || word == named.other_name) return named.scalar;
    }
    lines.refuse_line("a property has no type of PLY: char, uchar, short, ushort, int, uint, float or double");
}

void read_property(TextLines& lines, Header& header) {
    if (header.elements.empty()) lines.refuse_line("a property comes before the first element");
    Property property;
    TextLines probe = lines;
    if (probe.word() == "list") {
        (void)lines.word();
        property.count = scalar_of(lines);
        if (property.count->kind == Scalar::Kind::real) lines.refuse_line("the length of a list is not an integer");
    }
    property.value = scalar_of(lines);
    property.name = lines.word();
    header.elements.back().properties.push_back(std::move(property));
}

Encoding encoding_of(TextLines& lines) {
    const std::string_view word = lines.word();
    if (word == "ascii") return Encoding::text;
    if (word == "binary_little_endian") return Encoding::little_endian;
    if (word == "binary_big_endian") return Encoding::big_endian;
    lines.refuse_line("the format is not ascii, binary_little_endian or binary_big_endian");
}

Header read_header(TextLines& lines) {
    lines.need("'ply'");
    if (lines.word() != "ply") lines.refuse_line("'ply' is expected");
    Header header;
    for (;;) {
        lines.need("the rest of the header");
        const std::string_view word = lines.word();
        if (word == "end_header") return header;
        if (word == "format") {
            header.encoding = encoding_of(lines);
        } else if (word == "element") {
            Element& element = header.elements.emplace_back();
            element.name = lines.word();
            element.count = lines.integer("the number of elements", 0xFFFFFFFF);
        } else if (word == "property") {
            read_property(lines, header);
        }  // Other lines are comments, or the like.
    }
}

/// Reads the values of a text file, one element per line.
class TextValues {
public:
    static constexpr bool binary = false;
    explicit TextValues(TextLines& lines) : lines_(lines) {}
    void begin_element() { lines_.need("an element"); }
    bool more() { return !lines_.rest().empty(); }
    double value(const Scalar& scalar) {
        if (scalar.kind == Scalar::Kind::real) return lines_.number("a number");
        return double(lines_.number("an integer"));
    }

private:
    TextLines& lines_;
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
    double value(const Scalar& scalar) {
        if (file_.bytes.size() - at_ < scalar.bytes) refuse(file_.path, "ends in the middle of its elements");
        std::uint64_t bits = 0;
        for (unsigned i = 0; i < scalar.bytes; ++i) {
            const unsigned place = big_ ? scalar.bytes - 1 - i : i;
            bits |= std::uint64_t(std::uint8_t(file_.bytes[at_ + i])) << (8 * place);
        }
        at_ += scalar.bytes;
        return value_of(bits, scalar);
    }

private:
    static double value_of(std::uint64_t bits, const Scalar& scalar) {
        if (scalar.kind == Scalar::Kind::real) {
            return scalar.bytes == 4 ? double(std::bit_cast<float>(std::uint32_t(bits))) : std::bit_cast<double>(bits);
        }
        const unsigned unused = 64 - 8 * scalar.bytes;
        if (scalar.kind == Scalar::Kind::integer) return double(std::int64_t(bits << unused) >> unused);
        return double(bits);
    }

    const FileContent& file_;
    std::size_t at_;
    bool big_;
    std::uint64_t elements_ = 0;
};

/// Which property of an element is which coordinate, or the corners.
struct Roles {
    std::array<std::size_t, 3> coordinates = {none, none, none};
    std::size_t corners = none;
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

    explicit Roles(const Element& element) {
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const Property& property = element.properties[i];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (!property.count && property.name == std::string(1, "xyz"[axis])) coordinates[axis] = i;
            }
            if (property.count && (property.name == "vertex_indices" || property.name == "vertex_index")) corners = i;
        }
    }
};

template <typename Values>
class ElementReader {
public:
    ElementReader(const FileContent& file, Values& values) : file_(file), values_(values) {}

    void read_vertices(const Element& element, PlainMesh& mesh) {
        const Roles roles(element);
        for (const std::size_t role : roles.coordinates) {
            if (role == Roles::none) refuse(file_.path, "its vertices have no x, y or z");
        }
        const Scalar& scalar = element.properties[roles.coordinates[0]].value;
        mesh.rounded = Values::binary && scalar.kind == Scalar::Kind::real && scalar.bytes == 4;
        for (std::uint64_t i = 0; i < element.count; ++i) {
            constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
            Point3d& place = mesh.vertices.emplace_back(Point3d{unknown, unknown, unknown});
            visit(element, [&](std::size_t property, double value) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (roles.coordinates[axis] == property) place[axis] = value;
                }
            });
        }
    }

    void read_faces(const Element& element, std::uint64_t vertices, PlainMesh& mesh) {
        const Roles roles(element);
        if (roles.corners == Roles::none) refuse(file_.path, "its faces have no list vertex_indices");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            visit(element, [&](std::size_t property, double value) {
                if (property != roles.corners) return;
                if (!(value >= 0 && value < double(vertices)) || value != std::floor(value)) {
                    refuse(file_.path,
                           fmt::format("face {} has the corner {}, but there are {} vertices", i, value, vertices));
                }
                mesh.corners.push_back(std::uint32_t(value));
            });
            mesh.end_face();
        }
    }

    void skip(const Element& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) visit(element, [](std::size_t, double) {});
    }

private:
    /// Calls take(number of the property, value) for all values of an element. Lines of a text may end early, as some programs write
    /// them.
    template <typename Take>
    void visit(const Element& element, const Take& take) {
        values_.begin_element();
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (!values_.more()) return;
            const Property& property = element.properties[i];
            double count = 1;
            if (property.count) count = values_.value(*property.count);
            if (!(count >= 0 && count <= double(file_.bytes.size())))
                refuse(file_.path, "a list has an impossible length");
            for (double k = 0; k < count; ++k) take(i, values_.value(property.value));
        }
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
PlainMesh read_elements(const FileContent& file, const Header& header, Values values) {
    PlainMesh mesh;
    ElementReader<Values> reader(file, values);
    for (const Element& element : header.elements) {
        // An element has at least one byte in a binary file, and a line in a text file.
        const std::uint64_t least =
            std::max<std::uint64_t>(1, header.encoding == Encoding::text ? 2 : element.least_bytes());
        if (element.count > file.bytes.size() / least) {
            refuse(file.path, fmt::format("says that it has {} elements '{}', but it is too short for them",
                                          element.count, element.name));
        }
        if (element.name == "vertex") {
            reader.read_vertices(element, mesh);
        } else if (element.name == "face") {
            reader.read_faces(element, mesh.vertices.size(), mesh);
        } else {
            if (element.name == "tristrips") refuse(file.path, "has triangle strips, which octopair does not read");
            reader.skip(element);
        }
    }
    check_corners(file, mesh);
    return mesh;
}

}  // namespace

PlainMesh parse_ply(const FileContent& file) {
    TextLines lines(file);
    const Header header = read_header(lines);
    if (header.encoding == Encoding::text) return read_elements(file, header, TextValues(lines));
    return read_elements(file, header, BinaryValues(file, lines.offset(), header.encoding == Encoding::big_endian));
}

}  // namespace octopair::io
