// Distributions of the objects of all ranks by their places, as in a simulation whose ranks own regions of space.
#pragma once

#include <mpi.h>

#include <vector>

#include "octopair/objects.hpp"

namespace octopair::cluster {

// Both functions are collective, and return the boxes of this rank's region. The boxes lie in the unit cube.

/// Each rank has equally many boxes, one after another along the curve of octal codes.
std::vector<Box3f> in_order_of_space(MPI_Comm comm, std::vector<Box3f> own);
/// Each rank has the boxes of one block of a grid, in any order.
std::vector<Box3f> in_blocks(MPI_Comm comm, std::vector<Box3f> own);

}  // namespace octopair::cluster
