// parse_stl(): stereolithography files. A binary file has a header of 80 bytes, the number of triangles, and 50 bytes for each.
#include <bit>
#include <cmath>
#include <cstring>

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

std::uint64_t triangles_of_binary(std::string_view bytes) {
    return bytes.size() < header_bytes ? 0 : little_endian(bytes.data() + header_bytes - 4);
}

bool is_binary(std::string_view bytes) {
    if (bytes.size() < header_bytes) return false;
    // Some binary files begin with "solid", too. Their size tells them apart.
    const std::uint64_t size = header_bytes + triangle_bytes * triangles_of_binary(bytes);
    return size == bytes.size() || !bytes.starts_with("solid");
}

void add_corner(PlainMesh& mesh, const Point3d& place) {
    mesh.corners.push_back(std::uint32_t(mesh.vertices.size()));
    mesh.vertices.push_back(place);
}

PlainMesh parse_binary(const FileContent& file) {
    const std::uint64_t triangles = triangles_of_binary(file.bytes);
    if ((file.bytes.size() - header_bytes) / triangle_bytes < triangles) {
        refuse(file.path, fmt::format("says that it has {} triangles, but it is too short for them", triangles));
    }
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

/// Checks that the next line begins with the given words.
void expect(TextLines& lines, std::string_view first, std::string_view second = {}) {
    lines.need(first);
    if (lines.word() != first || (!second.empty() && lines.word() != second)) {
        lines.refuse_line(fmt::format("'{}{}{}' is expected", first, second.empty() ? "" : " ", second));
    }
}

/// Reads the facets of a solid, to its end.
void read_facets(TextLines& lines, PlainMesh& mesh) {
    for (;;) {
        lines.need("'facet' or 'endsolid'");
        const std::string_view word = lines.word();
        if (word == "endsolid") return;
        if (word != "facet") lines.refuse_line("'facet' or 'endsolid' is expected");
        if (mesh.vertices.size() > 0xFFFFFFFF - 3) lines.refuse_line("a solid has more than 2^32 - 1 vertices");
        expect(lines, "outer", "loop");
        for (int corner = 0; corner < 3; ++corner) {
            expect(lines, "vertex");
            Point3d place;
            for (double& at : place) at = lines.number("a coordinate");
            add_corner(mesh, place);
        }
        mesh.end_face();
        expect(lines, "endloop");
        expect(lines, "endfacet");
    }
}

}  // namespace

std::vector<PlainMesh> parse_stl(const FileContent& file) {
    if (is_binary(file.bytes)) return {parse_binary(file)};
    std::vector<PlainMesh> solids;
    TextLines lines(file);
    while (lines.next()) {
        if (lines.word() != "solid") lines.refuse_line("'solid' is expected");
        solids.emplace_back().name = lines.rest();
        read_facets(lines, solids.back());
    }
    if (solids.empty()) refuse(file.path, "has no solid");
    return solids;
}

}  // namespace octopair::io
