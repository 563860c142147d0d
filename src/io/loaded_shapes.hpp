// Shapes and poses of a loaded scene, or the triangles of a loaded scene, for the narrow phase.
//
// - Objects have the same numbers as their boxes.
// - Objects with the same shape share one entry of `shapes`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/object_details.hpp"
#include "octopair/filters.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Shapes, poses and attributes of n objects. Optional arrays are empty if no file sets a value.
struct LoadedShapes {
    std::vector<shape::Any> shapes;
    std::vector<std::uint32_t> geometry;  ///< n indices into `shapes`
    std::vector<Pose> poses;              ///< n poses
    std::vector<std::uint32_t> parents;   ///< n parent numbers; an object without a parent has a number of its own
    std::vector<Pose> end_poses;          ///< n poses at time 1, or empty; the default is the pose
    std::vector<double> padding;          ///< n paddings, or empty; the default is 0
    std::vector<std::uint32_t> groups;    ///< n bit masks, or empty; the default is bit 0
    std::vector<std::uint32_t> masks;     ///< n bit masks, or empty; the default is all bits

    static constexpr std::uint32_t default_groups = 1, default_mask = 0xFFFFFFFF;

    /// Appends the objects of `others`. Their objects, shapes and parents get the numbers after those of this scene.
    void append(LoadedShapes&& others);
};

/// Triangles as objects, in the world (octopair/shapes.hpp).
struct LoadedTriangles {
    std::vector<Triangle3d> triangles;
    std::vector<std::uint32_t> owners;  ///< for each triangle, the node that it belongs to (an index into owner_names)
    std::vector<std::string> owner_names;  ///< names of all nodes, including nodes without triangles
    ObjectDetails owner_details;           ///< empty, or a row per node

    /// Appends the triangles of `others`. Their triangles and owners get the numbers after those of this scene.
    void append(LoadedTriangles&& others);
};

}  // namespace octopair::io
