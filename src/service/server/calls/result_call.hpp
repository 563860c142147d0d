// The call Result: streams the pairs of a detached job, starting at a given pair, as they are found.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class ServerContext;

grpc::ServerWriteReactor<grpc::ByteBuffer>* start_result(ServerContext& server, grpc::CallbackServerContext& context,
                                                         const grpc::ByteBuffer& request);

}  // namespace octopair::service
