// The one place that decides which format a file has, and who reads it.
// Start here to add a new format of results.
//
// - A mark at the beginning of the content decides first, the ending of the name second (formats/content_marks.hpp). Case is ignored.
// - formats/format_table.cpp lists all formats.
// - Streams without an ending, such as "-" and /dev/fd/63, and files with an unknown ending have the format that their content shows.
// - Results have the format of their ending. Without one they are CSV.
//
// Scenes    scene_reader.cpp calls the reader of a format.
// Results   results/pair_writer.cpp and collision_writer.cpp write the formats.
#pragma once

#include <cstdint>
#include <string>

namespace octopair::io {

struct FileFormat;

/// Returns the ending of a file's name in lower case, with its dot; empty if the name has no ending.
std::string ending_of(const std::string& path);

/// The format of a scene file.
struct KnownFormat {
    const FileFormat* format = nullptr;  ///< null: not in the table
    /// Ending that names the format: that of the file, or if the content shows another format, the first ending of that one.
    std::string ending;
    bool marked = false;      ///< true if the content has the mark of the format
    bool by_content = false;  ///< true if the content decided, because the name has another ending or no ending
    bool misnamed = false;    ///< true if the ending of the name belongs to another format
};

/// Returns the format of a scene file. Reads the beginning of the file, if possible. For a stream with an ending, and a file that cannot
/// be opened, only the name decides.
/// Throws: Error{io_failed} for a stream without an ending.
KnownFormat known_format(const std::string& path);
inline std::string format_ending(const std::string& path) { return known_format(path).ending; }

/// Throws: Error{bad_input} with a remedy if the content of a file is not the scene itself: an empty file (other than CSV), a compressed
/// file, a pointer of Git LFS, an HTML page, text in UTF-16 or UTF-32 that its reader does not know, and a format that nobody reads.
void check_readable(const std::string& path);
/// Throws: Error{bad_input} as check_readable() for a file that is no scene, such as rules. An empty file is accepted.
void check_not_wrapped(const std::string& path);

/// Returns a warning "FILE: ..." about a file whose name has the ending of another format, or an empty text.
std::string name_warning(const std::string& path);

/// Format of a scene file by its reader. `mesh` includes the files that Assimp reads. Readers refuse files of format `unknown`.
enum class SceneFormat : std::uint8_t { npy, csv, json, mesh, unknown };

/// Format of a file of pairs or collisions. `npy` is an array of pairs; `csv` and `jsonl` are rows of text; `bcf` has topics of collisions.
enum class ResultFormat : std::uint8_t { npy, csv, jsonl, bcf };

/// Returns the format of a scene file. Returns `mesh` only if this build reads mesh files.
/// Throws: what known_format() throws.
SceneFormat scene_format(const std::string& path);
inline bool is_npy_file(const std::string& path) { return scene_format(path) == SceneFormat::npy; }
inline bool is_json_file(const std::string& path) { return scene_format(path) == SceneFormat::json; }
inline bool is_mesh_file(const std::string& path) { return scene_format(path) == SceneFormat::mesh; }
/// Returns whether Assimp reads a file: all mesh files but those that octopair's own readers read. Also returns true for some glTF files
/// that Assimp does not read (may_be_gltf_for_assimp()).
bool is_imported_file(const std::string& path);

/// The axis of a scene that points up.
enum class UpAxis : std::uint8_t { unknown, y, z };

/// Meaning of the coordinates of a scene, as far as it is known.
struct SceneSpace {
    UpAxis up = UpAxis::unknown;
    std::string unit;  ///< unit of length, for example "m"; empty if unknown

    bool operator==(const SceneSpace&) const = default;
};

/// Returns the axes and the unit that the format of a scene file prescribes, as they are after its reader.
SceneSpace format_space(const std::string& path);

/// Returns whether a file is a building model in IFC.
bool is_ifc_file(const std::string& path);

/// Returns whether a scene file may refer to other files that must be read too (glTF, JSON).
bool may_name_files(const std::string& path);

/// Returns the version of a scene file within its format, for example "IFC2X3", "1.4.1" or "binary"; empty if the beginning of the file
/// states none.
/// Throws: Error{io_failed}.
std::string version_of(const std::string& path);

/// Throws: Error{usage} for an ending that is not .npy, .csv, .jsonl, .bcf or .bcfzip.
ResultFormat result_format(const std::string& path);
/// Returns the format of a file of pairs. Throws: as result_format(); Error{usage} for a format that holds only collisions.
ResultFormat pairs_format(const std::string& path);

/// Returns whether the result format of `path` is an array. An empty path means standard output, which gets rows of text.
/// Throws: what result_format() throws.
bool is_array_file(const std::string& path);

}  // namespace octopair::io
