// parse_stl(): stereolithography files.
//
// A binary file has a header of 80 bytes, the number of triangles, and 50 bytes for each. Its header may begin with "solid", too.
//
// A text file has the statements `solid`, `facet`, `outer loop`, `vertex`, `endloop`, `endfacet` and `endsolid`, in capitals or small
// letters. Each may begin a line, or follow another. Words after a statement are left out, and so are lines with colours.
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::uint32_t little_endian(const char* bytes) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < 4; ++i) value |= std::uint32_t(std::uint8_t(bytes[i])) << (8 * i);
    return value;
}

/// Returns the number of triangles that the header states. Requires: the header is complete.
std::uint64_t stated_triangles(std::string_view bytes) { return little_endian(bytes.data() + header_bytes - 4); }

/// Returns whether a file is binary. In a text, the bytes of the number of triangles are characters, so the number is larger than
/// 151,587,080, and the text would have to be as large. Smaller numbers have bytes that no text has.
bool is_binary(std::string_view bytes) {
    const std::string_view header = bytes.substr(0, header_bytes);
    const bool has_zero = header.find('\0') != std::string_view::npos;
    return has_zero ||
           (header.size() == header_bytes && (bytes.size() - header_bytes) / triangle_bytes >= stated_triangles(bytes));
}

/// Returns the number of triangles to read: the stated one, or all if it was left 0.
/// Throws: Error{bad_input} if the file has fewer triangles than it states, or more.
std::uint64_t triangles_of_binary(const FileContent& file) {
    if (file.bytes.size() < header_bytes)
        refuse(file.path, "ends in its header; a binary STL file has one of 84 bytes. Copy or save the file again");
    const std::uint64_t stated = stated_triangles(file.bytes), bytes = file.bytes.size() - header_bytes;
    const std::uint64_t complete = bytes / triangle_bytes;
    if (bytes == stated * triangle_bytes) return stated;
    const bool has_whole_triangles = bytes % triangle_bytes == 0;
    if (stated == 0 && has_whole_triangles) {
        file.warn(fmt::format("its header says that it has 0 triangles; the {} that follow are read", complete));
        return complete;
    }
    if (complete < stated || has_whole_triangles || (stated == 0 && complete > 0)) {
        refuse(file.path, fmt::format("says that it has {} triangles, but {} follow its header; save it again", stated,
                                      has_whole_triangles ? fmt::format("{}", complete)
                                                          : fmt::format("{} bytes (50 each)", bytes)));
    }
    file.warn(fmt::format("the {} bytes after its {} triangles are not read", bytes - stated * triangle_bytes, stated));
    return stated;
}

void add_corner(PlainMesh& mesh, const Point3d& place) {
    mesh.corners.push_back(std::uint32_t(mesh.vertices.size()));
    mesh.vertices.push_back(place);
}

PlainMesh parse_binary(const FileContent& file) {
    const std::uint64_t triangles = triangles_of_binary(file);
    PlainMesh mesh;
    mesh.rounded = true;
    mesh.vertices.reserve(3 * triangles);
    for (std::uint64_t i = 0; i < triangles; ++i) {
        if (i % 4096 == 0) file.checkpoint(std::size_t(i * triangle_bytes));
        const char* const at = file.bytes.data() + header_bytes + i * triangle_bytes + 12;  // behind the normal
        for (unsigned corner = 0; corner < 3; ++corner) {
            Point3d place;
            for (unsigned axis = 0; axis < 3; ++axis) {
                place[axis] = double(std::bit_cast<float>(little_endian(at + 12 * corner + 4 * axis)));
                if (!std::isfinite(place[axis])) {
                    refuse(file.path, fmt::format("triangle {} has a coordinate that is not finite", i));
                }
            }
            add_corner(mesh, place);
        }
        mesh.end_face();
    }
    return mesh;
}

/// Returns whether a word is the wanted keyword, in capitals or small letters.
bool is(std::string_view word, std::string_view wanted) { return word == wanted || equal_in_any_case(word, wanted); }

/// Returns whether a word begins a line with a colour, which some programs add.
bool is_colour(std::string_view word) {
    return (word.front() == 'c' || word.front() == 'C') && (is(word, "color") || is(word, "colour"));
}

bool is_keyword(std::string_view word) {
    static constexpr std::string_view keywords[] = {"outer",    "facet",    "vertex", "endloop",
                                                    "endfacet", "endsolid", "end"};
    return std::any_of(std::begin(keywords), std::end(keywords), [&](auto wanted) { return is(word, wanted); });
}

class TextParser {
public:
    explicit TextParser(const FileContent& file) : file_(file), lines_(file) {}

    std::vector<PlainMesh> parse() {
        std::vector<PlainMesh> solids;
        while (lines_.next()) {
            if (!is(lines_.word(), "solid")) lines_.refuse_line("'solid' is expected");
            const std::string_view name = lines_.rest();
            solids.emplace_back().name = name;
            lines_.skip(name.size());
            read_facets(solids.back());
        }
        if (solids.empty()) refuse(file_.path, "has no solid");
        return solids;
    }

private:
    /// Reads the facets of a solid, to its end.
    void read_facets(PlainMesh& mesh) {
        for (;;) {
            constexpr std::string_view expected = "'facet' or 'endsolid'";
            const std::string_view word = statement(expected);
            if (is_end(word, "endsolid")) return;
            need(is(word, "facet"), expected);
            if (mesh.vertices.size() > 0xFFFFFFFF - 3) lines_.refuse_line("a solid has more than 2^32 - 1 vertices");
            read_facet(mesh);
        }
    }

    /// Reads a facet behind its first word.
    void read_facet(PlainMesh& mesh) {
        need(is(statement("'outer loop'"), "outer") && is(lines_.word(), "loop"), "'outer loop'");
        for (int corner = 0; corner < 3; ++corner) {
            need(is(statement("'vertex'"), "vertex"), "'vertex'");
            Point3d place;
            for (double& at : place) at = lines_.number("a coordinate");
            add_corner(mesh, place);
        }
        mesh.end_face();
        need(is_end(statement("'endloop'"), "endloop"), "'endloop'");
        need(is_end(statement("'endfacet'"), "endfacet"), "'endfacet'");
    }

    /// Returns the first word of the next statement: the next keyword in the line, or else the first word of the next line.
    std::string_view statement(std::string_view expected) {
        for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
            if (is_keyword(word)) return word;
        }
        for (;;) {
            lines_.need(expected);
            const std::string_view word = lines_.word();
            if (!is_colour(word)) return word;
        }
    }

    /// Returns whether a statement is an end, such as "endloop" or "end loop".
    bool is_end(std::string_view word, std::string_view wanted) {
        return is(word, wanted) || (is(word, "end") && is(lines_.word(), wanted.substr(3)));
    }

    void need(bool holds, std::string_view expected) const {
        if (!holds) lines_.refuse_line(fmt::format("{} is expected", expected));
    }

    const FileContent& file_;
    TextLines lines_;
};

}  // namespace

std::vector<PlainMesh> parse_stl(const FileContent& file) {
    if (is_binary(file.bytes)) return {parse_binary(file)};
    return TextParser(file).parse();
}

}  // namespace octopair::io
