#include "io/json/json_scene_file.hpp"

#include <filesystem>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/json/json_scene.hpp"
#ifdef OCTOPAIR_WITH_MESHES
#include "io/meshes/mesh_file.hpp"
#include "io/meshes/mesh_shapes.hpp"
#endif

namespace octopair::io {

namespace {

shape::Mesh load_mesh(const std::string& path) {
#ifdef OCTOPAIR_WITH_MESHES
    return whole_mesh_of(MeshFile(path, true));
#else
    refuse(path, "this build of octopair reads no mesh files");
#endif
}

}  // namespace

LoadedScene read_json_scene(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    Buffer<char> text{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(text.span()), stop);
    const std::filesystem::path directory = std::filesystem::path(path).parent_path();
    const auto load = [&](const std::string& name) { return load_mesh((directory / name).string()); };
    return parse_json_scene({text.data(), text.size()}, path, load, stop);
}

}  // namespace octopair::io
