// The calls that are a job each: Detect, in a stream, and DetectSmall, in one message each way.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::service {

class Host;

/// `host` outlives the call.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_detect(Host& host,
                                                                          grpc::CallbackServerContext& context);
grpc::ServerUnaryReactor* start_detect_small(Host& host, grpc::CallbackServerContext& context,
                                             const grpc::ByteBuffer& request, grpc::ByteBuffer& response);

}  // namespace octopair::service
