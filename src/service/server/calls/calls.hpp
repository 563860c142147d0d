// The calls of octopair.proto as a service that gRPC can register: each of them goes to its own file.
#pragma once

#include <memory>

namespace grpc {
class Service;
}  // namespace grpc

namespace octopair::service {

class Host;

/// `host` outlives the service.
std::unique_ptr<grpc::Service> make_calls(Host& host);

}  // namespace octopair::service
