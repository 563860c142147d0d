#include "io/formats.hpp"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <span>

#include <fmt/format.h>

#include "io/files/input_file.hpp"
#include "io/files/stream_input.hpp"
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

namespace {

/// Returns whether a path says nothing about the format: standard input or output ("-"), a stream, or a descriptor under /dev or
/// /proc.
bool lacks_name(const std::string& path) {
    return is_stream(path) || path == "/dev/stdin" || path.starts_with("/dev/fd/") ||
           path.starts_with("/proc/self/fd/");
}

/// Returns the format by the first bytes: .npy begins with a mark, JSON with a brace or bracket; everything else is CSV.
SceneFormat format_of_content(const std::string& path) {
    const InputFile file(path);
    std::string begin(std::size_t(std::min<std::uint64_t>(file.size(), 64)), '\0');
    file.read(0, std::as_writable_bytes(std::span(begin)));
    if (begin.starts_with("\x93NUMPY")) return SceneFormat::npy;
    const std::size_t first = begin.find_first_not_of(" \t\r\n");
    const bool json = first != std::string::npos && (begin[first] == '{' || begin[first] == '[');
    return json ? SceneFormat::json : SceneFormat::csv;
}

}  // namespace

SceneFormat scene_format(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".npy") return SceneFormat::npy;
    if (ending == ".csv") return SceneFormat::csv;
    if (ending == ".json") return SceneFormat::json;
#ifdef OCTOPAIR_WITH_MESHES
    if (is_mesh_ending(ending)) return SceneFormat::mesh;
#endif
    return lacks_name(path) ? format_of_content(path) : SceneFormat::unknown;
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
    if (path == "-" || path.starts_with("/dev/")) return ResultFormat::csv;
    throw Error(ErrorCode::usage,
                fmt::format("{}: unknown file type; the name of a pairs file must end in .npy, .csv or .jsonl", path));
}

bool is_array_file(const std::string& path) { return !path.empty() && result_format(path) == ResultFormat::npy; }

}  // namespace octopair::io
