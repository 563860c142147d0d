// Fuzzes the readers of OBJ, OFF, STL and PLY files. A file gives a mesh with valid corners, or one line that describes the error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stop_token>
#include <string_view>
#include <vector>

#include "io/meshes/plain/plain_mesh.hpp"
#include "octopair/error.hpp"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

void check(const octopair::io::PlainMesh& mesh, std::size_t size) {
    require(mesh.corners.size() <= size && mesh.vertices.size() <= size && mesh.ends.size() <= size);
    const std::uint64_t triangles = mesh.triangles();
    const octopair::shape::Mesh cut = octopair::io::cut_into_triangles(mesh);
    require(cut.triangles.size() == triangles);
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
    using namespace octopair;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const std::stop_token never;
    const io::FileContent file{text, "f", never};
    try {
        if (bytes[0] % 4 == 0) check(io::parse_off(file), size);
        if (bytes[0] % 4 == 1) check(io::parse_ply(file), size);
        if (bytes[0] % 4 >= 2) {
            for (const io::PlainMesh& mesh : bytes[0] % 4 == 2 ? io::parse_stl(file) : io::parse_obj(file))
                check(mesh, size);
        }
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input);
        const std::string_view words = error.what();
        require(words.starts_with("f: "));
        require(words.find('\n') == std::string_view::npos);
    }
    return 0;
}
