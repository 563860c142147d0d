// What scene files say of objects beside their boxes: shapes and poses, or the triangles of a set, for the exact stages.
//
// Plain data, numbered as the boxes are. A shape is there once, however many objects have it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "octopair/filters.hpp"
#include "octopair/shapes.hpp"

namespace octopair::io {

/// Of n objects. The arrays that may be empty are so where no file says anything else than the default.
struct LoadedShapes {
    std::vector<shape::Any> shapes;
    std::vector<std::uint32_t> geometry;  ///< of each object: which shape
    std::vector<Pose> poses;              ///< of each object
    std::vector<std::uint32_t>
        parents;                  ///< of each object: alike for those of one parent; unlike all others without one
    std::vector<Pose> end_poses;  ///< empty, or of each object: where it is at time 1; default its pose
    std::vector<double> padding;  ///< empty, or of each object; default 0
    std::vector<std::uint32_t> groups;  ///< empty, or of each object: bits; default 1
    std::vector<std::uint32_t> masks;   ///< empty, or of each object: bits; default all

    static constexpr std::uint32_t default_groups = 1, default_mask = 0xFFFFFFFF;

    /// Numbers the others' objects, shapes and parents on.
    void append(LoadedShapes&& others);
};

/// Triangles as objects, in the world (octopair/shapes.hpp).
struct LoadedTriangles {
    std::vector<Triangle3d> triangles;
    std::vector<std::uint32_t> owners;     ///< of each triangle: the object it would be part of, were nodes objects
    std::vector<std::string> owner_names;  ///< of all such objects, those without triangles too

    /// Numbers the others' triangles and owners on.
    void append(LoadedTriangles&& others);
};

}  // namespace octopair::io
