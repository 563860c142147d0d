// Tells the user where the page is.
#pragma once

#include "cli/view/loaded_view.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

/// Prints the address of the page on standard output, and opens it in the user's browser unless --no-browser is given.
void present(const ViewRequest& request, const viewer::PageServer& server);

}  // namespace octopair::cli
