// The calls that are a job each: Detect, in a stream, and DetectSmall, in one message each way.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class ServerContext;

/// `server` outlives the call.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_detect(ServerContext& server,
                                                                          grpc::CallbackServerContext& context);
grpc::ServerUnaryReactor* start_detect_small(ServerContext& server, grpc::CallbackServerContext& context,
                                             const grpc::ByteBuffer& request, grpc::ByteBuffer& response);

}  // namespace octopair::service
