// File formats by the ending of the file's name. Case is ignored. No other file maps endings to formats. Streams without an ending,
// such as "-" and /dev/fd/63, have the format that their first bytes show: .npy, JSON or CSV. Results go there as CSV.
//
// Scenes    scene_reader.cpp calls the reader of a format.
// Results   results/pair_writer.cpp, collision_writer.cpp and event_writer.cpp write the formats.
#pragma once

#include <cstdint>
#include <string>

namespace octopair::io {

/// Returns the ending of a file's name in lower case, with its dot; empty if the name has no ending.
std::string ending_of(const std::string& path);

/// Format of a scene file. Assimp reads `mesh` files. Readers refuse `unknown` files.
enum class SceneFormat : std::uint8_t { npy, csv, json, mesh, unknown };

/// Format of a file of pairs or collisions. `npy` is an array of pairs; the others are rows of text.
enum class ResultFormat : std::uint8_t { npy, csv, jsonl };

/// Returns the format of a scene file. Returns `mesh` only if this build reads mesh files. Reads streams without an ending.
/// Throws: Error{io_failed} for such a stream.
SceneFormat scene_format(const std::string& path);
inline bool is_npy_file(const std::string& path) { return scene_format(path) == SceneFormat::npy; }
inline bool is_json_file(const std::string& path) { return scene_format(path) == SceneFormat::json; }
inline bool is_mesh_file(const std::string& path) { return scene_format(path) == SceneFormat::mesh; }
/// Returns whether Assimp reads a file: all mesh files but those of simple formats (meshes/plain/).
bool is_imported_file(const std::string& path);

/// The axis of a scene that points up.
enum class UpAxis : std::uint8_t { unknown, y, z };

/// Meaning of the coordinates of a scene, as far as it is known.
struct SceneSpace {
    UpAxis up = UpAxis::unknown;
    std::string unit;  ///< unit of length, for example "m"; empty if unknown

    bool operator==(const SceneSpace&) const = default;
};

/// Returns the axes and the unit that the format of a scene file prescribes, after its reader.
SceneSpace format_space(const std::string& path);

/// Returns whether a file is a building model in IFC.
bool is_ifc_file(const std::string& path);

/// Returns whether a scene file may name other files that must be read too (glTF, JSON).
bool may_name_files(const std::string& path);

/// Throws: Error{usage} for an ending that is not .npy, .csv or .jsonl.
ResultFormat result_format(const std::string& path);

/// Returns whether the result format of `path` is an array. An empty path means standard output, which gets rows of text.
/// Throws: what result_format() throws.
bool is_array_file(const std::string& path);

}  // namespace octopair::io
