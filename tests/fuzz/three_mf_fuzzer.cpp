// Fuzzes the reader of 3MF. An input that begins like a ZIP archive is a file; any other one is the XML of a model, for which an archive is
// made. A file gives a scene with consistent arrays, or one line that describes the error.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <variant>

#include "io/meshes/three_mf/three_mf_scene.hpp"
#include "io/zip_writer.hpp"
#include "octopair/error.hpp"

namespace {

using namespace octopair;

constexpr std::string_view relationships =
    "<Relationships><Relationship Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel' "
    "Target='/m.model'/></Relationships>";

void require(bool holds) {
    if (!holds) std::abort();
}

void check(const io::LoadedScene& scene) {
    const auto& loaded = *scene.shapes;
    require(scene.names.size() == scene.objects && scene.details.rows.size() == scene.objects);
    require(loaded.geometry.size() == scene.objects && loaded.poses.size() == scene.objects);
    require(loaded.parents.size() == scene.objects);
    for (const Box3d& box : std::get<Buffer<Box3d>>(scene.boxes).span()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            require(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]) && box.min[axis] <= box.max[axis]);
        }
    }
    for (const std::uint32_t number : loaded.geometry) {
        const auto& mesh = std::get<shape::Mesh>(loaded.shapes.at(number));
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
        }
    }
}

std::string archive_of(std::string_view model) {
    test::ZipWriter zip;
    zip.add("_rels/.rels", relationships, {.deflate = false});
    zip.add("m.model", model, {.deflate = false});
    return zip.bytes();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view input(reinterpret_cast<const char*>(bytes), size);
    const std::string file = input.starts_with("PK") ? std::string(input) : archive_of(input);
    Buffer<std::byte> copy{file.size()};
    std::memcpy(copy.data(), file.data(), file.size());
    try {
        check(io::parse_three_mf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {}));
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::resource_limit);
        const std::string_view words = error.what();
        require(words.starts_with("f: "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
