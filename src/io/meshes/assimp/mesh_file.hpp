// MeshFile: a mesh file in memory, imported by Assimp, as a list of instances with names, poses and vertices.
//
// - An instance is a node whose meshes have at least one used vertex.
// - A vertex is used if a face of its mesh refers to it. If a mesh has no faces, all its vertices are used.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "base/memory.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/formats/unit_change.hpp"
#include "io/meshes/assimp/content/mesh_content.hpp"
#include "io/meshes/assimp/ifc_text.hpp"
#include "io/meshes/bounded_pose.hpp"
#include "io/meshes/faces/face_cutter.hpp"

namespace octopair::io {

/// A node that places one or more meshes in the world.
struct MeshInstance {
    const aiNode* node;
    std::string name;  ///< node path from the root, joined by "/"
    BoundedPose pose;  ///< product of the transforms along the path
    /// Sum of the largest coordinates of the translations along the path, in the unit of the world.
    double translations = 0;

    std::span<const unsigned> meshes() const { return {node->mMeshes, node->mNumMeshes}; }
};

class MeshFile {
public:
    /// Reads a file. With `triangles`, faces with more than three corners are cut into triangles (FaceCutter).
    /// Converts coordinates to `unit`, if it is not empty and the file states another unit.
    /// Throws: Error{bad_input} with Assimp's message if Assimp refuses the file, for a vertex index out of range, and if Assimp would place
    /// something wrongly (mesh_content.hpp); Error{io_failed}.
    MeshFile(const std::string& path, bool triangles, std::string_view unit = {});

    /// Returns all instances, in pre-order of their nodes.
    const std::vector<MeshInstance>& instances() const { return instances_; }
    /// Returns LoadedScene::largest_rounded: Assimp rounds vertices and transforms to float32.
    double largest_rounded() const;
    const aiScene& scene() const { return *scene_; }
    /// Returns the axes and the unit of the file: those of its format. AMF, FBX and X3D files may state their own.
    SceneSpace space() const;
    /// Returns the pose of the root node, in the unit of the world.
    BoundedPose world_pose() const;
    const UnitChange& unit_change() const { return change_; }
    const std::string& path() const { return path_; }
    const KnownFormat& known() const { return known_; }
    /// Returns the content that Assimp left out, as far as the text of the file shows it, for example "entities of type 3DSOLID (2)".
    const std::vector<std::string>& left_out() const { return content_.left_out; }
    /// Returns the facts that the text of an IFC file states; empty for other files, and for compressed files.
    const IfcText& ifc_text() const { return ifc_text_; }
    const aiMesh& mesh(unsigned number) const { return *scene_->mMeshes[number]; }
    /// Returns the used vertices of a mesh, each once, in the order of first use. Requires: an instance has the mesh.
    const std::vector<unsigned>& used_vertices(unsigned mesh) const { return *used_vertices_[mesh]; }

    /// Calls visit(corners) for each triangle of a mesh, in the order of the faces. Points and lines have none.
    /// Requires: an instance has the mesh; the file was read with `triangles`.
    template <typename Visit>
    void for_each_triangle(unsigned number, const Visit& visit) const {
        if (cut_meshes_[number]) {
            for (const Corners& corners : *cut_meshes_[number]) visit(corners);
            return;
        }
        for (const aiFace& face : std::span(mesh(number).mFaces, mesh(number).mNumFaces)) {
            if (face.mNumIndices == 3) visit(Corners{face.mIndices[0], face.mIndices[1], face.mIndices[2]});
        }
    }
    /// Returns the faces that cross themselves, with the names of the first instances that have such faces.
    const CrossingFaces& crossing_faces() const { return crossing_faces_; }

    static Point3d vertex(const aiMesh& mesh, unsigned index) {
        const aiVector3D& place = mesh.mVertices[index];
        return {double(place.x), double(place.y), double(place.z)};
    }
    /// Returns the position of a vertex in the world.
    /// Throws: Error{bad_input} that names the node and the vertex, if the position in the file or in the world is not finite.
    BoundedPoint posed_vertex(const MeshInstance& instance, const aiMesh& mesh, unsigned index) const;
    /// Throws: Error{bad_input} because `value`, a coordinate of the vertex, is not finite.
    [[noreturn]] void refuse_vertex(const MeshInstance& instance, unsigned index, double value) const;

private:
    using Corners = std::array<unsigned, 3>;

    const aiScene& import(const std::string& path);
    const aiScene* import_by_name(const std::string& path);
    /// Reads a file whose name does not have the ending of its format.
    const aiScene* import_by_content(const InputFile& file);
    void cut_faces();
    bool has_vertices(const MeshInstance& instance);
    std::vector<unsigned> find_used_vertices(const MeshInstance& instance, const aiMesh& mesh) const;

    std::string path_;
    KnownFormat known_;
    IfcText ifc_text_;
    MeshContent content_;
    Assimp::Importer importer_;
    const aiScene* scene_;
    UnitChange change_;
    std::vector<MeshInstance> instances_;
    std::vector<std::optional<std::vector<unsigned>>>
        used_vertices_;  // per mesh; empty until a node with the mesh is visited
    std::vector<std::optional<std::vector<Corners>>> cut_meshes_;  // per mesh; set if it has faces with more corners
    CrossingFaces crossing_faces_;
};

/// Returns the pose of a node within its parent, in Assimp's axes.
BoundedPose pose_of(const aiNode& node);

/// Returns the pose of the root node. Assimp turns or mirrors some formats to its own axes (formats/format_table.hpp). The pose undoes this
/// change, so coordinates are those of the file. COLLADA files keep Assimp's axes and unit, which then are those of glTF.
BoundedPose root_pose(const aiNode& root, const KnownFormat& known);

}  // namespace octopair::io
