// Shapes as triangles, for pictures. Round shapes become polyhedra.
#pragma once

#include "octopair/shapes.hpp"
#include "viewer/scene/scene_contents.hpp"

namespace octopair::cli {

/// Returns the triangles of a shape. `extent`: length of the scene, which limits the drawing of a plane.
viewer::ShownShape shown_shape(const shape::Any& shape, double extent);

}  // namespace octopair::cli
