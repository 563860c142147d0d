// The gRPC service of octopair.proto. The service forwards each call to the file that implements the call.
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
