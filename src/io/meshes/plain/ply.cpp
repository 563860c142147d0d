// parse_ply(): the polygon file format of Stanford.
//
// Vertices and faces are read, in any order. Other elements and properties are skipped. A text is a stream of values. Usually, but not
// always, each element has a line of its own.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/ply_header.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

/// Reads the values of a text file.
class TextValues {
public:
    static constexpr bool binary = false;
    /// `by_lines`: each element has a line of its own, which may end early.
    TextValues(TextLines& lines, bool by_lines) : lines_(lines), by_lines_(by_lines) {}
    void begin_element() {
        if (by_lines_) return lines_.require_line("an element");
        constexpr std::uint64_t elements_between_checks = 4096;
        if (++elements_ % elements_between_checks == 0) lines_.checkpoint();
    }
    bool more() {
        if (!by_lines_ || !lines_.rest().empty()) return true;
        ends_early_ = true;
        return false;
    }
    void end_element() {
        if (by_lines_ && surplus_ == 0 && !lines_.rest().empty()) surplus_ = lines_.line_number();
    }
    double value(const PlyScalar& scalar) {
        const std::string_view what = scalar.kind == PlyScalar::Kind::real ? "a number" : "an integer";
        if (!by_lines_) lines_.find_word(what);
        return lines_.number(what);
    }
    /// Skips a value, which may be any word.
    void skip(const PlyScalar&) {
        if (!by_lines_) lines_.find_word("a number");
        if (lines_.word().empty()) lines_.refuse_line("the line ends where a number should follow");
    }
    [[noreturn]] void refuse_element(const FileContent&, std::string_view why) const { lines_.refuse_line(why); }

    /// Returns the first line that has more values than its element has properties; 0 if no line has too many.
    std::uint64_t surplus() const { return surplus_; }
    /// Returns whether a line ended before the last property.
    bool ends_early() const { return ends_early_; }

private:
    TextLines& lines_;
    bool by_lines_;
    std::uint64_t elements_ = 0;
    std::uint64_t surplus_ = 0;
    bool ends_early_ = false;
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
    void warn_of_rest(const FileContent& file) const {
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
        if (file_.bytes.size() - at_ < scalar.bytes)
            refuse(file_.path,
                   fmt::format("ends at byte {}, in the middle of its elements; copy or save it again", at_));
        at_ += scalar.bytes;
    }
    [[noreturn]] static void refuse_element(const FileContent& file, std::string_view why) { refuse(file.path, why); }

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

/// The property of an element that is each coordinate, or the list of corners. All other properties are skipped.
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
            if (role == Roles::none)
                refuse(file_.path, "its header gives vertices no property x, y or z; save it with all three");
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
        if (roles.corners == Roles::none)
            refuse(file_.path,
                   "its header gives faces no list 'vertex_indices'; save it with this name for the corners");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            const std::size_t visited = visit(element, roles, [&](std::size_t property, double value) {
                if (property != roles.corners) return;
                if (!(value >= 0 && value < double(vertices)) || value != std::floor(value)) {
                    values_.refuse_element(
                        file_, fmt::format("face {} has the corner {}, but there are {} vertices", i, value, vertices));
                }
                mesh.corners.push_back(std::uint32_t(value));
            });
            if (visited <= roles.corners)
                values_.refuse_element(file_, fmt::format("face {} ends before its corners", i));
            mesh.end_face();
        }
    }

    void skip(const PlyElement& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) visit(element, Roles(), [](std::size_t, double) {});
    }

private:
    /// Calls take(number of the property, value) for the values of an element that have a role. Returns the number of properties that were
    /// read. Lines of a text may end early, because some programs leave out the last values.
    template <typename Take>
    std::size_t visit(const PlyElement& element, const Roles& roles, const Take& take) {
        values_.begin_element();
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            if (!values_.more()) return i;
            const PlyProperty& property = element.properties[i];
            double count = 1;
            if (property.count) count = values_.value(*property.count);
            if (!(count >= 0 && count <= double(file_.bytes.size())))
                values_.refuse_element(file_, fmt::format("a list has the impossible length {}", count));
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

/// Throws: Error{bad_input} if a face has a corner without a finite place. Vertices without a face are not checked.
void check_corners(const FileContent& file, const PlainMesh& mesh) {
    for (const std::uint32_t corner : mesh.corners) {
        for (const double coordinate : mesh.vertices[corner]) {
            if (!std::isfinite(coordinate))
                refuse(file.path,
                       fmt::format("vertex {}, which a face uses, has a coordinate that is not finite; repair the mesh",
                                   corner));
        }
    }
}

template <typename Values>
PlainMesh read_elements(const FileContent& file, const PlyHeader& header, Values& values) {
    PlainMesh mesh;
    ElementReader<Values> reader(file, values);
    for (const PlyElement& element : header.elements) {
        const bool is_read = element.name == "vertex" || element.name == "face";
        if (element.properties.empty() && !is_read) continue;  // the element has no content, or at most an empty line
        // An element has at least one byte in a binary file, and a line in a text file.
        const std::uint64_t least =
            std::max<std::uint64_t>(1, header.encoding == PlyEncoding::text ? 2 : element.least_bytes());
        if (element.count > file.bytes.size() / least) {
            refuse(
                file.path,
                fmt::format(
                    "its header says that it has {} elements '{}', but it is too short for them; copy or save it again",
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
    check_corners(file, mesh);
    return mesh;
}

PlainMesh read_binary(const FileContent& file, const TextLines& lines, const PlyHeader& header) {
    BinaryValues values(file, lines.offset(), header.encoding == PlyEncoding::big_endian);
    PlainMesh mesh = read_elements(file, header, values);
    values.warn_of_rest(file);
    return mesh;
}

/// The content of a text file, as it was read by lines or as a stream.
struct PlyText {
    PlainMesh mesh;
    std::uint64_t surplus = 0;      ///< first line that is not read whole; 0: none
    bool ends_early = false;        ///< a line ends before the last value of its element
    std::uint64_t unread_line = 0;  ///< first line after the last element; 0: none
    std::uint64_t last_line = 0;    ///< number of the last line that was read
    std::optional<Error> error;     ///< error in this reading of the file, if the file is invalid

    bool is_complete() const { return !error && unread_line == 0; }
    bool has_lines() const { return surplus == 0 && !ends_early; }
};

PlyText read_text(const FileContent& file, bool by_lines) {
    TextLines lines(file);
    const PlyHeader header = read_ply_header(lines);
    TextValues values(lines, by_lines);
    PlyText text;
    (void)lines.skip_line();
    try {
        text.mesh = read_elements(file, header, values);
        if (by_lines) (void)lines.skip_line();
        if (!lines.rest().empty() || lines.next()) text.unread_line = lines.line_number();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        text.error = error;
    }
    text.last_line = lines.line_number();
    text.surplus = values.surplus();
    text.ends_early = values.ends_early();
    return text;
}

/// Returns the content of a text file. In most files, each element has a line of its own, and some programs leave out values at the end
/// of lines, or add some. All other files are streams of values. The content may have an error.
PlyText read_any_text(const FileContent& file) {
    PlyText by_lines = read_text(file, true);
    if (by_lines.is_complete() && by_lines.has_lines()) return by_lines;
    FileContent again = file;
    again.progress = {};  // Reading by lines has already reported the whole progress.
    PlyText stream = read_text(again, false);
    if (stream.is_complete()) return stream;
    if (!by_lines.error || !stream.error) return by_lines;
    return by_lines.has_lines() || stream.last_line <= by_lines.last_line ? std::move(by_lines) : std::move(stream);
}

}  // namespace

PlainMesh parse_ply(const FileContent& file) {
    TextLines lines(file);
    const PlyHeader header = read_ply_header(lines);
    if (header.encoding != PlyEncoding::text) return read_binary(file, lines, header);
    PlyText text = read_any_text(file);
    if (text.error) throw Error(*text.error);
    if (text.surplus > 0) {
        file.warn(fmt::format("line {} has more values than its element has properties; the rest of it is not read",
                              text.surplus));
    }
    if (text.unread_line > 0) {
        file.warn(fmt::format("from line {} on it is not read, because its header says that it ends before",
                              text.unread_line));
    }
    return std::move(text.mesh);
}

}  // namespace octopair::io
