// Fuzzes the reader of glTF and GLB files. A file gives a scene with consistent arrays, or one line that describes the error.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <variant>

#include "io/meshes/gltf/gltf_scene.hpp"
#include "octopair/error.hpp"

namespace {

using namespace octopair;

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    Buffer<std::byte> copy{size};
    if (size > 0) std::memcpy(copy.data(), bytes, size);
    try {
        const auto scene = io::parse_gltf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {});
        if (scene) check(*scene);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::resource_limit ||
                error.code() == ErrorCode::io_failed);
        const std::string_view words = error.what();
        require(words.starts_with("f: "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
