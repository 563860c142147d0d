// The side of the ranks: the calls that are measured.
#pragma once

#include <mpi.h>

#include <stop_token>

#include "cluster/measured.hpp"

namespace octopair::cluster {

/// Collective: so many calls together, and each rank as many alone, after one that is not counted; each rank makes its slice
/// of the scene. What the first rank returns has the costs of all. Pairs are listed in octal order, as ranks with one thread find them.
Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop);

}  // namespace octopair::cluster
