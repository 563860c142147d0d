// Fuzzes the readers of OBJ, OFF, STL and PLY files. A file gives a mesh with valid corners, or one line that describes the error.
#include <cmath>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string_view>

#include "fuzz/require.hpp"
#include "io/edge_balance.hpp"
#include "io/meshes/plain/plain_mesh.hpp"

namespace {

using namespace octopair;
using fuzz::require;

void check(const octopair::io::PlainMesh& mesh, std::size_t size) {
    require(mesh.corners.size() <= size && mesh.vertices.size() <= size && mesh.ends.size() <= size);
    octopair::io::CrossingFaces crossing;
    const octopair::shape::Mesh cut = octopair::io::cut_into_triangles(mesh, crossing, {});
    octopair::test::EdgeBalance edges;
    const auto place_of = [&](std::uint32_t corner) { return mesh.vertices[corner]; };
    std::uint64_t begin = 0;
    for (const std::uint64_t end : mesh.ends) {
        if (end - begin > 2) edges.add(std::span(mesh.corners).subspan(begin, end - begin), place_of, -1);
        begin = end;
    }
    for (const auto& triangle : cut.triangles) edges.add(triangle, place_of, 1);
    require(edges.is_zero());
    for (const auto& triangle : cut.triangles) {
        for (const std::uint32_t corner : triangle) {
            require(corner < cut.vertices.size());
            for (const double at : cut.vertices[corner]) require(std::isfinite(at));
        }
    }
}

}  // namespace

/// The first byte chooses the format.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const std::stop_token never;
    const io::FileContent file{text, "f", never};
    fuzz::require_clear_errors({.begin = "f: "}, [&] {
        if (bytes[0] % 4 == 0) check(io::parse_off(file), size);
        if (bytes[0] % 4 == 1) check(io::parse_ply(file), size);
        if (bytes[0] % 4 >= 2) {
            for (const io::PlainMesh& mesh : bytes[0] % 4 == 2 ? io::parse_stl(file) : io::parse_obj(file))
                check(mesh, size);
        }
    });
    return 0;
}
