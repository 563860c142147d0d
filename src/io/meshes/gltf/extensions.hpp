// Extensions of glTF: which ones a file may require.
//
//   geometry     KHR_mesh_quantization, EXT_mesh_gpu_instancing: read.
//   no geometry  materials, textures, lights, metadata: accepted and not read.
//   by Assimp    KHR_draco_mesh_compression: Assimp reads the file.
//   others       refused by name, because the geometry may be in the extension.
#pragma once

#include "io/meshes/gltf/gltf_file.hpp"

namespace octopair::io::gltf {

/// Name of the extension that places many copies of a node.
inline constexpr const char* instancing = "EXT_mesh_gpu_instancing";

/// Name of the extension that says which nodes are shown.
inline constexpr const char* visibility = "KHR_node_visibility";

/// Throws: Error{bad_input} that names an extension that the file requires, and that octopair does not read.
void check_required_extensions(const GltfFile& file);

/// Returns whether Assimp must read a file: it has compressed meshes without a copy that is not compressed.
/// Throws: Error{bad_input} if such a file also uses extensions that Assimp ignores.
bool needs_assimp(const GltfFile& file);

}  // namespace octopair::io::gltf
