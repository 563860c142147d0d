// One study on MPI ranks: octopair-bench starts itself under mpirun with the hidden option --on-ranks FILE, and rank 0 writes
// what was measured to that file.
#pragma once

#include <functional>
#include <string>

#include "cli/ranks/cluster.hpp"

namespace octopair::bench {

/// Makes the text of a file. Only rank 0 calls it.
using MakeText = std::function<std::string()>;

/// Collective. Runs `measure` on all ranks, and writes the text that rank 0 makes of the result to `path`. Returns the exit
/// status. Throws: what fails on one rank alone.
int run_on_ranks(const std::string& path, const std::function<MakeText(cli::Cluster&)>& measure);

}  // namespace octopair::bench
