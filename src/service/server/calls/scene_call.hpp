// The call Scene as a gRPC reactor. The reactor deletes itself when the call is done.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class ServerContext;

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_scene(ServerContext& server,
                                                                         grpc::CallbackServerContext& context);

}  // namespace octopair::service
