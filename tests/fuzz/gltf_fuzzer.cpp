// Fuzzes the reader of glTF and GLB files. A file gives a scene with consistent arrays, or one line that describes the error.
#include <cstdint>
#include <cstring>
#include <string_view>

#include "fuzz/mesh_scene_check.hpp"
#include "fuzz/require.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"

using namespace octopair;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    Buffer<std::byte> copy{size};
    if (size > 0) std::memcpy(copy.data(), bytes, size);
    fuzz::require_clear_errors(
        {.begin = "f: ",
         .codes = {ErrorCode::bad_input, ErrorCode::resource_limit, ErrorCode::io_failed},
         .printable = true},
        [&] {
            const auto scene = io::parse_gltf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {});
            if (scene) fuzz::check_mesh_scene(*scene);
        });
    return 0;
}
