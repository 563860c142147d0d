// parse_stl(): stereolithography files.
//
// A binary file has a header of 80 bytes, the number of triangles, and 50 bytes for each. Its header may begin with "solid", too.
//
// A text file is a stream of words: the statements `solid`, `facet`, `outer loop`, `vertex`, `endloop`, `endfacet` and `endsolid`, in
// capitals or small letters. Each may begin a line, or follow another, and its words may be on several lines. Words after a statement are
// left out, and so are lines with colours. The name of a solid ends with its line, or before the words `facet normal` or `endsolid`.
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

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

/// Returns the number of triangles to read: the stated number. If the stated number is 0, returns the number that the file has room for.
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
        const char* const at = file.bytes.data() + header_bytes + i * triangle_bytes + 12;  // after the normal
        for (unsigned corner = 0; corner < 3; ++corner) {
            Point3d place;
            for (unsigned axis = 0; axis < 3; ++axis) {
                place[axis] = double(std::bit_cast<float>(little_endian(at + 12 * corner + 4 * axis)));
                if (!std::isfinite(place[axis])) {
                    refuse(file.path,
                           fmt::format("triangle {} (at byte {}) has a coordinate that is not finite; repair the mesh",
                                       i, header_bytes + i * triangle_bytes));
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

/// Returns whether a word may be meant as a number, also one that is not finite, such as "-nan(ind)" or "1.#QNAN".
bool is_like_number(std::string_view word) {
    if (word.front() == '-' || word.front() == '+') word.remove_prefix(1);
    if (word.empty()) return true;
    const char first = word.front();
    return (first >= '0' && first <= '9') || first == '.' || equal_in_any_case(word.substr(0, 3), "nan") ||
           equal_in_any_case(word.substr(0, 3), "inf");
}

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Returns the first word from `at` on, and moves `at` behind this word. Returns nothing at the end.
std::string_view word_at(std::string_view text, std::size_t& at) {
    while (at < text.size() && is_blank(text[at])) ++at;
    const std::size_t begin = at;
    while (at < text.size() && !is_blank(text[at])) ++at;
    return text.substr(begin, at - begin);
}

std::string_view without_blank_after(std::string_view text) {
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Returns whether a word is `endsolid`, or `end` before `solid`. If so, moves `at` behind the last word.
bool ends_solid(std::string_view word, std::string_view text, std::size_t& at) {
    if (is(word, "endsolid")) return true;
    std::size_t after = at;
    if (!is(word, "end") || !is(word_at(text, after), "solid")) return false;
    at = after;
    return true;
}

/// Returns the name at the begin of the line after `solid`.
std::string_view name_of_solid(std::string_view line) {
    std::size_t at = 0;
    for (std::string_view word = word_at(line, at); !word.empty(); word = word_at(line, at)) {
        const std::string_view name = without_blank_after(line.substr(0, at - word.size()));
        std::size_t after = at;
        if (is(word, "facet") && is(word_at(line, after), "normal")) return name;
        if (!ends_solid(word, line, at)) continue;
        const std::string_view rest = line.substr(std::min(line.find_first_not_of(" \t", at), line.size()));
        const bool ends_here = rest.empty() || rest.starts_with(name);
        if (ends_here && !name.empty()) return name;
    }
    return line;
}

/// Returns where a line has the next solid after `endsolid NAME`: a word `solid` with `facet` or `endsolid` after it, unless the line
/// ends with `solid` and a name. Returns the size of the line if there is none.
std::size_t begin_of_solid(std::string_view line) {
    std::size_t at = 0, begin = line.size();
    for (std::string_view word = word_at(line, at); !word.empty(); word = word_at(line, at)) {
        if (begin == line.size() && is(word, "solid")) begin = at - word.size();
        if (begin != line.size() && (is(word, "facet") || ends_solid(word, line, at))) return begin;
    }
    return line.size();
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
        while (follows_in_line_ || lines_.next()) {
            follows_in_line_ = false;
            expect(is(noted(lines_.word()), "solid"), "'solid'");
            const std::string_view name = name_of_solid(lines_.rest());
            solids.emplace_back().name = name;
            lines_.skip(name.size());
            read_facets(solids.back());
            skip_name(solids.back().name);
        }
        if (solids.empty())
            refuse(file_.path, "has no solid: it is neither a text that begins with 'solid' nor a binary STL file");
        return solids;
    }

private:
    /// Reads the facets of a solid, to its end.
    void read_facets(PlainMesh& mesh) {
        for (;;) {
            constexpr std::string_view expected = "'facet' or 'endsolid'";
            const std::string_view word = statement(expected);
            if (is_end(word, "endsolid")) return;
            expect(is(word, "facet"), expected);
            if (mesh.vertices.size() > 0xFFFFFFFF - 3) lines_.refuse_line("a solid has more than 2^32 - 1 vertices");
            read_facet(mesh);
        }
    }

    /// Skips the name after `endsolid`. Finds out whether another solid follows in the line.
    void skip_name(std::string_view name) {
        std::string_view rest = lines_.rest();
        if (rest.starts_with(name)) rest.remove_prefix(name.size());
        const std::size_t begin = begin_of_solid(rest);
        follows_in_line_ = begin < rest.size();
        lines_.skip(lines_.rest().size() - rest.size() + begin);
    }

    /// Reads a facet behind its first word.
    void read_facet(PlainMesh& mesh) {
        if (++facets_ % 4096 == 0) lines_.checkpoint();
        skip_normal();
        expect(is(statement("'outer loop'"), "outer") && is(next_word("'loop'"), "loop"), "'outer loop'");
        for (int corner = 0; corner < 3; ++corner) {
            expect(is(statement("'vertex'"), "vertex"), "'vertex'");
            Point3d place;
            for (double& at : place) {
                lines_.find_word("a coordinate");
                at = lines_.number("a coordinate");
            }
            add_corner(mesh, place);
        }
        mesh.end_face();
        expect(is_end(statement("'endloop'"), "endloop"), "'endloop'");
        expect(is_end(statement("'endfacet'"), "endfacet"), "'endfacet'");
    }

    std::string_view next_word(std::string_view expected) {
        lines_.find_word(expected);
        return noted(lines_.word());
    }

    /// Skips the word `normal` and the three numbers after it. Some of them may be missing, or on later lines.
    void skip_normal() {
        constexpr int words = 4;
        for (int i = 0; i < words; ++i) {
            const std::uint64_t line = lines_.line_number();
            lines_.find_word("'outer loop'");
            const std::string_view word = lines_.peek();
            const bool is_of_normal = is(word, "normal") || is_like_number(word);
            is_at_begin_of_line_ = !is_of_normal && lines_.line_number() != line;
            if (!is_of_normal) return;
            lines_.skip(word.size());
        }
    }

    /// Returns the first word of the next statement: the next keyword in the line, or else the first word of the next line.
    std::string_view statement(std::string_view expected) {
        const bool is_at_begin = std::exchange(is_at_begin_of_line_, false);
        for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word()) {
            if (is_keyword(word) || (is_at_begin && !is_colour(word))) return noted(word);
            if (is_at_begin) (void)lines_.skip_line();
        }
        for (;;) {
            lines_.require_line(expected);
            const std::string_view word = lines_.word();
            if (!is_colour(word)) return noted(word);
        }
    }

    /// Stores a word for the messages of expect(), and returns this word.
    std::string_view noted(std::string_view word) { return last_word_ = word; }

    /// Returns whether a statement is an end, such as "endloop" or "end loop".
    bool is_end(std::string_view word, std::string_view wanted) {
        return is(word, wanted) || (is(word, "end") && is(next_word(wanted), wanted.substr(3)));
    }

    void expect(bool holds, std::string_view expected) const {
        if (!holds) lines_.refuse_line(fmt::format("{} is expected, not '{}'", expected, shown(last_word_)));
    }

    const FileContent& file_;
    TextLines lines_;
    bool follows_in_line_ = false;      // true if the next solid begins in the line in which the last one ends
    bool is_at_begin_of_line_ = false;  // true if the next word is the first word of its line, and was not read yet
    std::uint64_t facets_ = 0;
    std::string_view last_word_;
};

}  // namespace

std::vector<PlainMesh> parse_stl(const FileContent& file) {
    if (is_binary(file.bytes)) return {parse_binary(file)};
    return TextParser(file).parse();
}

}  // namespace octopair::io
