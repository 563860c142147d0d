// Options of `octopair view`.
#pragma once

#include "cli/command/command.hpp"
#include "cli/view/loaded_view.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

void add_view_options(Command& command, ViewRequest& request);

/// Sorts the inputs into scenes, a result, and the address of a server. Sets defaults.
/// Throws: Error{usage} for options that do not fit together; Error{io_failed} for an input that cannot be read.
void check_view_options(ViewRequest& request);

/// Returns where the page is served. With --listen, makes a random token.
/// Throws: Error{usage} for an invalid address.
viewer::PageServerOptions server_options(const ViewRequest& request);

}  // namespace octopair::cli
