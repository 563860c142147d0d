// `octopair serve --engine mpi`: the first rank answers clients, the others find pairs with it.
#pragma once

#include "cli/server/serve_options.hpp"

namespace octopair::cli {

/// On all ranks. Returns the exit status of this one; ends the program where a rank no longer takes part.
int serve_on_ranks(const ServeRequest& request);

}  // namespace octopair::cli
