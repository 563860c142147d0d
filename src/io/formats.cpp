#include "io/formats.hpp"

#include <algorithm>
#include <filesystem>
#include <initializer_list>

#include <fmt/format.h>

#include "io/meshes/mesh_reader.hpp"
#include "io/meshes/plain/plain_scene.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending) {
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    }
    return ending;
}

SceneFormat scene_format(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".npy") return SceneFormat::npy;
    if (ending == ".csv") return SceneFormat::csv;
    if (ending == ".json") return SceneFormat::json;
#ifdef OCTOPAIR_WITH_MESHES
    if (is_mesh_ending(ending)) return SceneFormat::mesh;
#endif
    return SceneFormat::unknown;
}

bool is_imported_file(const std::string& path) {
#ifdef OCTOPAIR_WITH_MESHES
    return is_mesh_file(path) && !is_plain_ending(ending_of(path));
#else
    return is_mesh_file(path);
#endif
}

bool is_ifc_file(const std::string& path) {
    const std::string ending = ending_of(path);
    return ending == ".ifc" || ending == ".ifczip";
}

SceneSpace format_space(const std::string& path) {
    const std::string ending = ending_of(path);
    const auto is_any_of = [&](std::initializer_list<std::string_view> endings) {
        return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    if (is_ifc_file(path)) return {UpAxis::z, "m"};  // Assimp scales to metres
    // Assimp turns and scales COLLADA to the axes and the unit that glTF and X3D prescribe.
    if (is_any_of({".gltf", ".glb", ".dae", ".zae", ".x3d", ".x3db", ".wrl"})) return {UpAxis::y, "m"};
    return {};
}

bool may_name_files(const std::string& path) {
    const std::string ending = ending_of(path);
    return ending == ".gltf" || ending == ".json";
}

ResultFormat result_format(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".npy") return ResultFormat::npy;
    if (ending == ".csv") return ResultFormat::csv;
    if (ending == ".jsonl") return ResultFormat::jsonl;
    throw Error(ErrorCode::usage,
                fmt::format("{}: unknown file type; the name of a pairs file must end in .npy, .csv or .jsonl", path));
}

bool is_array_file(const std::string& path) { return !path.empty() && result_format(path) == ResultFormat::npy; }

}  // namespace octopair::io
