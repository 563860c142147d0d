// File formats: the one table that says what the ending of a file's name means. Upper and lower case are the same.
#pragma once

#include <cstdint>
#include <string>

namespace octopair::io {

/// Returns the ending of a file's name in lower case, with its dot; empty if there is none.
std::string ending_of(const std::string& path);

/// How a scene file is read. `mesh`: by Assimp. `unknown`: refused.
enum class SceneFormat : std::uint8_t { npy, csv, json, mesh, unknown };

/// How pairs or collisions are written. `npy`: an array of pairs; the others are rows of text.
enum class ResultFormat : std::uint8_t { npy, csv, jsonl };

/// `mesh` only if this build reads mesh files.
SceneFormat scene_format(const std::string& path);
inline bool is_npy_file(const std::string& path) { return scene_format(path) == SceneFormat::npy; }
inline bool is_json_file(const std::string& path) { return scene_format(path) == SceneFormat::json; }
inline bool is_mesh_file(const std::string& path) { return scene_format(path) == SceneFormat::mesh; }

/// Returns whether a scene file may name other files, which are read with it (glTF, JSON).
bool has_parts(const std::string& path);

/// Throws: Error{usage} for an ending that is not .npy, .csv or .jsonl.
ResultFormat result_format(const std::string& path);

/// Returns whether a result goes to an array. An empty path means standard output, which gets rows of text.
/// Throws: as result_format().
bool is_array_file(const std::string& path);

}  // namespace octopair::io
