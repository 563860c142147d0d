// Readers of simple mesh formats, and scenes of their files: one object for each mesh of the file, or for each triangle. Numbers have the
// precision of the file: text is read as float64, to the nearest number.
//
//   off   OFF with any of ST, C and N before it, with three coordinates, as text
//   obj   polygons of objects and groups
//   stl   as text or binary
//   ply   as text or binary, of either byte order; float or double
//
// The readers need memory in proportion to the file, whatever the file says.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "io/loaded_scene.hpp"
#include "io/meshes/faces/face_cutter.hpp"
#include "io/scene_reader.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// A mesh of polygons. Face i has the corners [ends[i - 1], ends[i]) of `corners`, indices of vertices.
struct PlainMesh {
    std::string name;  ///< empty if the file gives none
    std::set<std::string> materials;
    bool rounded = false;  ///< true if the file has coordinates of float32
    std::vector<Point3d> vertices;
    std::vector<std::uint32_t> corners;
    std::vector<std::uint64_t> ends;

    void end_face() { ends.push_back(corners.size()); }
    /// Returns the number of triangles, if no face touches itself: a face of n corners has n - 2 triangles.
    std::uint64_t triangles() const;
};

/// Cuts the faces into triangles, in order (FaceCutter). Leaves out faces with fewer than three corners. Adds each face that crosses
/// itself to `crossing`, with the name of the mesh.
/// Throws: Error{cancelled}.
shape::Mesh cut_into_triangles(PlainMesh mesh, CrossingFaces& crossing, const std::stop_token& stop);

/// Text or bytes of a file, and its name for messages.
struct FileContent {
    std::string_view bytes;
    std::string_view path;
    const std::stop_token& stop;
    std::function<void(double)> progress =
        {};  ///< called with the part of the file that is parsed, from 0 to 1; or empty
    std::vector<std::string>* warnings = nullptr;  ///< receives notes for the user about the file; or null

    /// Parsers call this from time to time. `offset`: bytes parsed. Throws: Error{cancelled}.
    void checkpoint(std::size_t offset) const;
    /// Adds the warning "PATH: WHAT".
    void warn(std::string_view what) const;
};

// Parse the content of a file. Throw: Error{bad_input} "PATH: line N: ..." or "PATH: ..."; Error{cancelled}.
std::vector<PlainMesh> parse_obj(const FileContent& file);
PlainMesh parse_off(const FileContent& file);
std::vector<PlainMesh> parse_stl(const FileContent& file);
PlainMesh parse_ply(const FileContent& file);

/// Returns whether files with this ending have a simple format. Requires: `ending` is in lower case.
bool is_plain_ending(std::string_view ending);

/// Reads a file of a simple format. The name of an object is that of the file, if its only mesh has no name or is a solid of STL. For
/// other files, "/" follows, and then the name of the mesh, or "#" and its position.
/// Throws: what the parsers throw; Error{io_failed, resource_limit}.
LoadedScene read_plain_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop);

/// Reads all meshes of such a file as one mesh, for a JSON scene that names the file. Adds the file's LoadedScene::largest_rounded and
/// warnings to `scene`.
shape::Mesh read_plain_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop);

}  // namespace octopair::io
