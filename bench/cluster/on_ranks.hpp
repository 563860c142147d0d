// Measurement of calls on the ranks.
#pragma once

#include <mpi.h>

#include <stop_token>

#include "cluster/measured.hpp"

namespace octopair::cluster {

/// Collective. Measures `rounds` calls of all ranks together, then at least as many calls of each rank alone. Warm-up
/// calls are not counted. Each rank makes its slice of the scene. Rank 0 returns the costs of all ranks. Pairs are
/// listed in octal order, by ranks with one thread.
Measured measure_on_ranks(MPI_Comm comm, const Setup& setup, unsigned rounds, const std::stop_token& stop);

}  // namespace octopair::cluster
