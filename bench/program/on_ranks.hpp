// Study on MPI ranks: octopair-bench starts a second instance under mpirun with the hidden option --on-ranks FILE.
// Rank 0 of that instance writes the results to the file.
#pragma once

#include <functional>
#include <string>

#include "cli/ranks/cluster.hpp"

namespace octopair::bench {

/// Makes the text of a file. Called only on rank 0.
using MakeText = std::function<std::string()>;

/// Collective. Runs `measure` on all ranks; rank 0 writes the text of the result to `path`. Returns the exit status.
/// Throws: errors that occur on some ranks only.
int run_on_ranks(const std::string& path, const std::function<MakeText(cli::Cluster&)>& measure);

}  // namespace octopair::bench
