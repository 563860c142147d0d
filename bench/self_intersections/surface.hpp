// A closed mesh that passes through itself: a bumpy sphere with arms that are pushed inward, through each other and out on
// the far side.
#pragma once

#include <cstdint>

#include "octopair/shapes.hpp"

namespace octopair::bench {

/// About so many triangles, of the six sides of a cube, in rows. A function of its arguments alone.
shape::Mesh make_surface(std::uint32_t triangles, std::uint32_t seed);

}  // namespace octopair::bench
