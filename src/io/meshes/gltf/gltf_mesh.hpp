// GltfMesh: a mesh of a glTF file, decoded to float64 triangles.
//
// - Triangles, strips and fans become triangles, in the order of the file. A primitive without indices uses its vertices in order.
// - A primitive has the vertices that its triangles use, in the order of their first use. Primitives share no vertices.
// - Points and lines give only vertices, which boxes enclose.
// - Morph targets are ignored.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/meshes/gltf/accessor.hpp"
#include "io/meshes/gltf/gltf_file.hpp"
#include "io/meshes/placed_meshes.hpp"

namespace octopair::io::gltf {

struct GltfMesh {
    SharedMesh shared;        ///< its loose vertices are those of points and lines
    double largest = 0;       ///< largest absolute coordinate
    bool has_floats = false;  ///< true if coordinates are float32 in the file
    double step = 0;  ///< largest distance between neighbouring values of integers; 0 if no coordinates are integers
    bool has_targets = false;         ///< true if it has morph targets
    std::size_t incomplete = 0;       ///< number of primitives whose last vertices make no complete face
    std::size_t without_surface = 0;  ///< number of primitives that are points or lines
    std::string first_incomplete;     ///< message about the first incomplete primitive, without the file
};

/// Decodes meshes of one file. Keeps working memory from mesh to mesh.
class MeshDecoder {
public:
    explicit MeshDecoder(GltfFile& file) : file_(file) {}

    /// Returns a mesh. `node`: name of a node that has the mesh, for messages.
    /// Throws: Error{bad_input} for an index out of range and for a vertex that is not finite; Error{resource_limit, cancelled};
    /// what GltfFile::view() throws.
    GltfMesh decode(std::uint64_t number, std::string_view node);

private:
    /// Numbers of the vertices of a primitive, in the order of first use.
    class VertexNumbers {
    public:
        void begin(std::uint64_t vertices);
        /// Returns the number of a vertex, and whether this is its first use. `next`: number for a vertex that is new.
        std::pair<std::uint32_t, bool> number_of(std::uint64_t vertex, std::uint32_t next);

    private:
        std::vector<std::uint32_t> used_in_,
            numbers_;  // per vertex: the last primitive that used it, and its number there
        std::uint32_t primitive_ = 0;
    };

    struct Primitive;
    void add_primitive(const JsonFields& fields, std::string_view node, GltfMesh& mesh);
    /// Appends the vertices that the primitive uses to `to`. Returns for each corner the number of its vertex in `to`.
    std::vector<std::uint32_t> add_vertices(const Primitive& primitive, std::uint64_t corners,
                                            std::vector<Point3d>& to);

    GltfFile& file_;
    VertexNumbers numbers_;
};

/// Throws: Error{bad_input} "FILE: node 'NODE': vertex N has the coordinate VALUE, which is not finite".
[[noreturn]] void refuse_vertex(const std::string& file, std::string_view node, std::uint64_t vertex, double value);

}  // namespace octopair::io::gltf
