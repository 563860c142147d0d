// Runs one call of the remote engine as a job on the server.
//
// A job with small input and result uses one message each way. Other jobs use a stream. If the stream breaks, the client sends
// the whole job again with the same id, and the server omits the pairs that the client has received already.
#pragma once

#include "engine/request.hpp"

namespace octopair::service {

class Connection;

/// Returns the summary of the call. Throws: Error; what the sinks for pairs and progress throw.
Summary find_remotely(Connection& connection, const detail::Request& request, const detail::Output& output,
                      const detail::Control& control);

}  // namespace octopair::service
