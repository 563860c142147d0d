// One call of the remote engine, as a job of the server's.
//
// Small input goes in one message, and so does a small result. All else goes in a stream; where that breaks, the whole job
// is sent again, under its own id, and the pairs that were there already are left out by the server.
#pragma once

#include "engine/request.hpp"

namespace octopair::service {

class Connection;

/// Throws Error, and what a sink or a progress throws.
Summary find_remotely(Connection& connection, const detail::Request& request, const detail::Output& output,
                      const detail::Control& control);

}  // namespace octopair::service
