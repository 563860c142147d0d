// parse_off(): the Object File Format of Geomview.
#include <algorithm>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

/// Reads the header. The first line may also have the counts already. Returns whether it has.
bool begins_with_counts(TextLines& lines) {
    TextLines probe = lines;
    const std::string_view word = probe.word();
    if (!word.empty() && word.find_first_not_of("0123456789") == std::string_view::npos) return true;
    (void)lines.word();
    if (word != "OFF" && word != "COFF" && word != "NOFF" && word != "CNOFF" && word != "STOFF") {
        lines.refuse_line("not a header that octopair reads: OFF, COFF, NOFF, CNOFF or STOFF");
    }
    if (lines.rest() == "BINARY") lines.refuse_line("octopair reads OFF files as text only");
    return !lines.rest().empty();
}

}  // namespace

PlainMesh parse_off(const FileContent& file) {
    TextLines lines(file, '#');
    lines.need("the header");
    if (!begins_with_counts(lines)) lines.need("the number of vertices");
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
    return mesh;
}

}  // namespace octopair::io
