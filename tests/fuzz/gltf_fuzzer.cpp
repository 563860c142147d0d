// Fuzzes the reader of glTF and GLB files. A file gives a scene with consistent arrays, or one line that describes the error.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "fuzz/mesh_scene_check.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"
#include "octopair/error.hpp"

using namespace octopair;
using test::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    Buffer<std::byte> copy{size};
    if (size > 0) std::memcpy(copy.data(), bytes, size);
    try {
        const auto scene = io::parse_gltf_scene("f", std::move(copy), {io::MeshObjects::node, true, {}}, {});
        if (scene) test::check_mesh_scene(*scene);
    } catch (const Error& error) {
        require(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::resource_limit ||
                error.code() == ErrorCode::io_failed);
        const std::string_view words = error.what();
        require(words.starts_with("f: "));
        require(std::none_of(words.begin(), words.end(), [](char c) { return c >= 0 && c < ' '; }));
    }
    return 0;
}
