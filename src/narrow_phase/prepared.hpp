// PreparedShape: a shape with all that the exact stages make of it once, to be shared by its objects.
#pragma once

#include <memory>

#include "narrow_phase/convex/convex_solid.hpp"
#include "narrow_phase/vertex_blocks.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct MeshTree;  // mesh_tree.hpp

/// In the shape's own space, rounded outward; of planes, and of meshes without vertices, nothing.
struct ShapeBounds {
    Box3d box = {};
    Point3d centre = {};  ///< the box's
    double radius = 0;    ///< of a sphere around the centre that holds all
    bool bounded = false;
};

struct detail::PreparedShape {
    shape::Any shape;
    ShapeBounds bounds;
    ConvexSolid convex;     ///< exists for all but planes and meshes
    VertexBlocks vertices;  ///< of hulls, and of meshes those that a triangle uses
    /// Of meshes; of convex shapes, a tree of one node, their box; of planes none.
    std::shared_ptr<const MeshTree> tree;
};

}  // namespace octopair
