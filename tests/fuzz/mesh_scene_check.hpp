// Checks of scenes that fuzzed readers of meshes return.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "fuzz/require.hpp"
#include "io/loaded_scene.hpp"

namespace octopair::fuzz {

/// Requires the arrays of a mesh scene to be consistent.
inline void check_mesh_scene(const io::LoadedScene& scene) {
    const auto& loaded = *scene.shapes;
    require(scene.names.size() == scene.objects && scene.details.rows.size() == scene.objects);
    require(loaded.geometry.size() == scene.objects && loaded.poses.size() == scene.objects);
    require(loaded.parents.size() == scene.objects);
    for (const Box3d& box : std::get<Buffer<Box3d>>(scene.boxes).span()) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            require(std::isfinite(box.min[axis]) && std::isfinite(box.max[axis]) && box.min[axis] <= box.max[axis]);
        }
    }
    for (const std::uint32_t number : loaded.geometry) {
        const auto& mesh = std::get<shape::Mesh>(loaded.shapes.at(number));
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size());
        }
    }
}

}  // namespace octopair::fuzz
