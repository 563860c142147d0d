// Runs `octopair serve --engine mpi`: rank 0 answers clients, and all ranks find pairs.
#pragma once

#include "cli/server/serve_options.hpp"

namespace octopair::cli {

/// Collective. Returns the exit status of this rank. Ends the program if a rank no longer responds.
int serve_on_ranks(const ServeRequest& request);

}  // namespace octopair::cli
