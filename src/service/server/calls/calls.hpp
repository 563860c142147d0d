// The calls of octopair.proto as a service that gRPC can register: each of them goes to its own file.
#pragma once

#include <memory>

namespace grpc {
class Service;
}  // namespace grpc

namespace octopair::service {

class ServerContext;

/// `server` outlives the service.
std::unique_ptr<grpc::Service> make_calls(ServerContext& server);

}  // namespace octopair::service
