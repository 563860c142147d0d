// The gRPC service of octopair.proto. It forwards each call to its function (call_handlers.hpp).
#pragma once

#include <memory>

namespace grpc {
class Service;
}  // namespace grpc

namespace octopair::service {

class ServerContext;

/// Requires: `server` outlives the service.
std::unique_ptr<grpc::Service> make_calls(ServerContext& server);

}  // namespace octopair::service
