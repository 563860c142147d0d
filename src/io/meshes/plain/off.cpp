// parse_off(): the Object File Format of Geomview.
#include <algorithm>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

bool is_digits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

/// Returns the length of the keyword at the begin of a word: OFF, after any of ST, C and N. Returns 0 if there is none. A small n is
/// another keyword, for vertices of any number of coordinates.
std::size_t keyword_length(std::string_view word) {
    for (std::size_t at = 0; at < word.size();) {
        const auto has = [&](std::string_view part) { return equal_in_any_case(word.substr(at, part.size()), part); };
        if (has("OFF")) return at + 3;
        if (has("ST")) {
            at += 2;
        } else if (has("C") || word[at] == 'N') {
            ++at;
        } else {
            return 0;
        }
    }
    return 0;
}

/// Reads the keyword, which may be missing. Goes to the counts, on the same line or the next.
void go_to_counts(TextLines& lines) {
    lines.need("the header");
    const std::string_view word = lines.peek();
    if (is_digits(word)) return;
    const std::size_t length = keyword_length(word);
    if (length == 0 || !is_digits(word.substr(length))) {
        lines.refuse_line(
            fmt::format("the header is '{}'; octopair reads OFF with any of ST, C and N before it, that is "
                        "with three coordinates",
                        shown(word)));
    }
    lines.skip(length);  // The number of vertices may follow without a space.
    if (equal_in_any_case(lines.peek(), "BINARY")) {
        lines.refuse_line("octopair reads OFF files as text only; save it as text");
    }
    if (lines.rest().empty()) lines.need("the number of vertices");
}

}  // namespace

PlainMesh parse_off(const FileContent& file) {
    TextLines lines(file, '#');
    go_to_counts(lines);
    // The shortest lines are "0 0 0" and "0".
    const std::uint64_t most_vertices = std::min<std::uint64_t>(file.bytes.size() / 6 + 1, 0xFFFFFFFF);
    const std::uint64_t vertices = lines.integer("the number of vertices", most_vertices);
    const std::uint64_t faces = lines.integer("the number of faces", file.bytes.size() / 2 + 1);

    PlainMesh mesh;
    mesh.vertices.reserve(vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) {
        lines.need("a vertex");
        Point3d& place = mesh.vertices.emplace_back();
        for (double& at : place) at = lines.number("a coordinate");
    }
    mesh.ends.reserve(faces);
    mesh.corners.reserve(3 * faces);
    for (std::uint64_t i = 0; i < faces; ++i) {
        lines.need("a face");
        const std::uint64_t corners = lines.integer("the number of corners", file.bytes.size());
        for (std::uint64_t k = 0; k < corners; ++k) {
            if (vertices == 0) lines.refuse_line("a face has corners, but there are no vertices");
            mesh.corners.push_back(std::uint32_t(lines.integer("a corner", vertices - 1)));
        }
        mesh.end_face();
    }
    if (lines.next())
        file.warn(
            fmt::format("from line {} on it is not read, because the header says that it has {} vertices and {} faces",
                        lines.line_number(), vertices, faces));
    return mesh;
}

}  // namespace octopair::io
