// Scenes from 3MF files: one object for each mesh of the build, or for each triangle.
//
// - Numbers are the nearest float64. Transforms are in float64, and boxes are rounded outward (io/meshes/bounded_pose.hpp).
// - Coordinates are in the unit of the file, which LoadedScene::space names.
// - Objects with the same mesh share a shape.
// - An object is a mesh in the world: an item with a mesh, or each mesh among the components of an item.
// - The order of objects is that of the items, and within an item that of its components, depth first.
// - A label is the name of an object; without one, the part number of the item or of the object.
// - A name is the path of the labels from the item on, joined by "/". With several items, it begins with ROOT. An object without a label
//   has "#" and its position. If siblings have the same label, "#" and the position follow it.
#pragma once

#include <cstddef>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"
#include "io/loaded_scene.hpp"
#include "io/scene_reader.hpp"

namespace octopair::io {

/// Returns whether files with this ending are 3MF. Requires: `ending` is in lower case.
bool is_three_mf_ending(std::string_view ending);

/// Reads a 3MF file.
/// Throws: Error{bad_input} that names the part and the line; Error{io_failed, resource_limit, cancelled}.
LoadedScene read_three_mf_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop);
/// Like read_three_mf_scene(), with the content of the file.
LoadedScene parse_three_mf_scene(const std::string& path, Buffer<std::byte> bytes, const SceneContent& content,
                                 const std::stop_token& stop);

/// Reads all triangles of a 3MF file as one mesh, in the world. Adds the file's warnings to `scene`.
shape::Mesh read_three_mf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop);

/// Returns the version of 3MF of a file, for example "core 2015/02". Throws: as read_three_mf_scene().
std::string three_mf_version(const std::string& path);

}  // namespace octopair::io
