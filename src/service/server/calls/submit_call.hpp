// The call Submit: stores a detached job in the state folder and queues it.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class ServerContext;

grpc::ServerReadReactor<grpc::ByteBuffer>* start_submit(ServerContext& server, grpc::CallbackServerContext& context,
                                                        grpc::ByteBuffer& response);

}  // namespace octopair::service
