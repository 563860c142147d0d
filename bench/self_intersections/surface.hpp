// Closed mesh that intersects itself: a bumpy sphere with arms pushed inward, through each other and out on the far
// side.
#pragma once

#include <cstdint>

#include "octopair/shapes.hpp"

namespace octopair::bench {

/// Returns a mesh with about `triangles` triangles, in rows on the six sides of a cube. Depends only on the arguments.
shape::Mesh make_surface(std::uint32_t triangles, std::uint32_t seed);

}  // namespace octopair::bench
