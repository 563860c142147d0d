#include "cli/view/server_view.hpp"
namespace octopair::cli {
void view_server(const ViewRequest&, const std::stop_token&) {}
}  // namespace octopair::cli
