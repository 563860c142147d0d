// The shapes and triangles of a mesh file, for the narrow phase.
#include "io/meshes/assimp/scene_parts.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "octopair/error.hpp"

namespace octopair::io {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// A mesh of a file, by its number.
struct NumberedMesh {
    const MeshFile& file;
    unsigned number;
};

/// Appends the triangles of a mesh to `to`. `place(i)` returns the position of vertex i.
template <typename Place>
void append_mesh(const NumberedMesh& mesh, const Place& place, shape::Mesh& to) {
    std::vector<std::uint32_t> numbers(mesh.file.mesh(mesh.number).mNumVertices, none);
    mesh.file.for_each_triangle(mesh.number, [&](const std::array<unsigned, 3>& corners) {
        std::array<std::uint32_t, 3> triangle;
        for (unsigned k = 0; k < 3; ++k) {
            std::uint32_t& number = numbers[corners[k]];
            if (number == none) {
                if (to.vertices.size() == none)
                    throw Error(ErrorCode::resource_limit, "a mesh has more than 2^32 - 1 vertices");
                number = std::uint32_t(to.vertices.size());
                to.vertices.push_back(place(corners[k]));
            }
            triangle[k] = number;
        }
        to.triangles.push_back(triangle);
    });
}

shape::Mesh shape_of(const MeshFile& file, const MeshInstance& instance) {
    shape::Mesh shape;
    for (const unsigned number : instance.meshes()) {
        const aiMesh& mesh = file.mesh(number);
        append_mesh(
            {file, number}, [&](unsigned index) { return MeshFile::vertex(mesh, index); }, shape);
    }
    return shape;
}

}  // namespace

LoadedShapes shapes_of(const MeshFile& file) {
    LoadedShapes loaded;
    std::map<std::vector<unsigned>, std::uint32_t> numbers;
    std::map<const aiNode*, std::uint32_t> parents;
    for (const MeshInstance& instance : file.instances()) {
        const auto meshes = instance.meshes();
        const auto [shape, is_new] = numbers.try_emplace({meshes.begin(), meshes.end()}, loaded.shapes.size());
        if (is_new) loaded.shapes.emplace_back(shape_of(file, instance));
        loaded.geometry.push_back(shape->second);
        loaded.poses.push_back(instance.pose.value());
        // Only the root has no parent, so no other node gets its parent number.
        loaded.parents.push_back(parents.try_emplace(instance.node->mParent, parents.size()).first->second);
    }
    return loaded;
}

LoadedTriangles triangles_of(const MeshFile& file) {
    LoadedTriangles loaded;
    loaded.owner_details = details_of(file);
    for (const MeshInstance& instance : file.instances()) {
        const auto owner = std::uint32_t(loaded.owner_names.size());
        loaded.owner_names.push_back(instance.name);
        for (const unsigned number : instance.meshes()) {
            const aiMesh& mesh = file.mesh(number);
            file.for_each_triangle(number, [&](const std::array<unsigned, 3>& corners) {
                Triangle3d triangle;
                for (unsigned k = 0; k < 3; ++k) {
                    triangle[k] = file.posed_vertex(instance, mesh, corners[k]).value;
                    for (const double value : triangle[k]) {
                        if (!std::isfinite(float(value)))
                            file.refuse_vertex(instance, corners[k], double(float(value)));
                    }
                }
                loaded.triangles.push_back(triangle);
                loaded.owners.push_back(owner);
            });
        }
    }
    return loaded;
}

shape::Mesh whole_mesh_of(const MeshFile& file) {
    shape::Mesh shape;
    for (const MeshInstance& instance : file.instances()) {
        for (const unsigned number : instance.meshes()) {
            const aiMesh& mesh = file.mesh(number);
            append_mesh(
                {file, number}, [&](unsigned index) { return file.posed_vertex(instance, mesh, index).value; }, shape);
        }
    }
    return shape;
}

}  // namespace octopair::io
