// Functions that start the calls of octopair.proto. calls.cpp forwards each call to its function.
// Each function returns gRPC's reactor of the call; the reactor deletes itself when the call is done. The calls about jobs find
// only jobs that the caller sees (net/caller.hpp).
//
// Requires: `server` outlives the call.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include <memory>

namespace grpc {
class Service;
}  // namespace grpc

namespace octopair::service {

class ServerContext;

// calls.cpp

/// Returns the gRPC service of octopair.proto. Requires: `server` outlives the service.
std::unique_ptr<grpc::Service> make_calls(ServerContext& server);

// detect_call.cpp

/// Runs one attached job: the job and its pairs are streams.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_detect(ServerContext& server,
                                                                          grpc::CallbackServerContext& context);
/// Runs one attached job: the job is one message, and the pairs are one message.
grpc::ServerUnaryReactor* start_detect_small(ServerContext& server, grpc::CallbackServerContext& context,
                                             const grpc::ByteBuffer& request, grpc::ByteBuffer& response);

// scene_call.cpp

/// Runs a scene: receives the calls of the scene, and answers each step.
grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* start_scene(ServerContext& server,
                                                                         grpc::CallbackServerContext& context);

// watch_call.cpp

/// Returns the running scenes that the caller sees.
grpc::ServerUnaryReactor* start_list_scenes(ServerContext& server, grpc::CallbackServerContext& context,
                                            const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
/// Sends the state of a scene after a step.
grpc::ServerWriteReactor<grpc::ByteBuffer>* start_watch_scene(ServerContext& server,
                                                              grpc::CallbackServerContext& context,
                                                              const grpc::ByteBuffer& request);

// submit_call.cpp

/// Stores a detached job in the state folder and queues it.
grpc::ServerReadReactor<grpc::ByteBuffer>* start_submit(ServerContext& server, grpc::CallbackServerContext& context,
                                                        grpc::ByteBuffer& response);

// result_call.cpp

/// Streams the pairs of a detached job, starting at a given pair, as they are found.
grpc::ServerWriteReactor<grpc::ByteBuffer>* start_result(ServerContext& server, grpc::CallbackServerContext& context,
                                                         const grpc::ByteBuffer& request);

// job_calls.cpp

/// Returns version, engine and limits of the server.
grpc::ServerUnaryReactor* start_describe(ServerContext& server, grpc::CallbackServerContext& context,
                                         const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
grpc::ServerUnaryReactor* start_status(ServerContext& server, grpc::CallbackServerContext& context,
                                       const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
grpc::ServerUnaryReactor* start_wait(ServerContext& server, grpc::CallbackServerContext& context,
                                     const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
/// Cancels the job, and answers when the job has ended, after at most 10 s.
grpc::ServerUnaryReactor* start_cancel(ServerContext& server, grpc::CallbackServerContext& context,
                                       const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
grpc::ServerUnaryReactor* start_release(ServerContext& server, grpc::CallbackServerContext& context,
                                        const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
grpc::ServerUnaryReactor* start_list(ServerContext& server, grpc::CallbackServerContext& context,
                                     const grpc::ByteBuffer& request, grpc::ByteBuffer& response);
/// Asks the server to end (ServerOptions::on_drain).
grpc::ServerUnaryReactor* start_drain(ServerContext& server, grpc::CallbackServerContext& context,
                                      const grpc::ByteBuffer& request, grpc::ByteBuffer& response);

}  // namespace octopair::service
