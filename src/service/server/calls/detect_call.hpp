// The calls that run one attached job: Detect (streams in both directions) and DetectSmall (one message in each direction).
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class ServerContext;

/// Requires: `server` outlives the call.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_detect(ServerContext& server,
                                                                          grpc::CallbackServerContext& context);
grpc::ServerUnaryReactor* start_detect_small(ServerContext& server, grpc::CallbackServerContext& context,
                                             const grpc::ByteBuffer& request, grpc::ByteBuffer& response);

}  // namespace octopair::service
