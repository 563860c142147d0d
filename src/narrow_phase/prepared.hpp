// PreparedShape: a shape with the data that the exact stages compute once and share among all objects of the shape.
#pragma once

#include <memory>

#include "narrow_phase/convex/convex_solid.hpp"
#include "narrow_phase/vertex_blocks.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

struct MeshTree;  // mesh_tree.hpp

/// Bounds of a shape in its own coordinates, rounded outward.
struct ShapeBounds {
    Box3d box = {};
    Point3d centre = {};   ///< centre of `box`
    double radius = 0;     ///< radius of a sphere around `centre` that contains the shape
    bool bounded = false;  ///< false for planes and for meshes without triangles: there are no bounds
};

struct detail::PreparedShape {
    shape::Any shape;
    ShapeBounds bounds;
    ConvexSolid convex;     ///< exists for all but planes and meshes
    VertexBlocks vertices;  ///< points of a hull, or vertices of a mesh that some triangle uses; otherwise empty
    /// Bounding hierarchy of a mesh; for convex shapes a tree of one node, their box; null for planes.
    std::shared_ptr<const MeshTree> tree;
};

}  // namespace octopair
