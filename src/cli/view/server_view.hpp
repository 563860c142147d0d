// Shows the jobs and the scenes of a server (`octopair serve`).
#pragma once

#include <stop_token>

#include "cli/view/loaded_view.hpp"

namespace octopair::cli {

/// Serves a page with the state of the server until a stop request.
/// Throws: Error{engine_failed} if the server cannot be reached.
void view_server(const ViewRequest& request, const std::stop_token& stop);

}  // namespace octopair::cli
