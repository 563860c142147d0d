// The calls about existing jobs: Status, Wait, Cancel, Release, List. They find only jobs of the caller.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

namespace octopair::v1 {
class JobList;
class JobName;
class JobReport;
class ListRequest;
class WaitRequest;
}  // namespace octopair::v1

namespace octopair::service {

class ServerContext;

grpc::ServerUnaryReactor* start_status(ServerContext& server, grpc::CallbackServerContext& context,
                                       const v1::JobName& request, v1::JobReport& response);
grpc::ServerUnaryReactor* start_wait(ServerContext& server, grpc::CallbackServerContext& context,
                                     const v1::WaitRequest& request, v1::JobReport& response);
/// Cancels the job, and answers when the job has ended, after at most 10 s.
grpc::ServerUnaryReactor* start_cancel(ServerContext& server, grpc::CallbackServerContext& context,
                                       const v1::JobName& request, v1::JobReport& response);
grpc::ServerUnaryReactor* start_release(ServerContext& server, grpc::CallbackServerContext& context,
                                        const v1::JobName& request, v1::JobReport& response);
grpc::ServerUnaryReactor* start_list(ServerContext& server, grpc::CallbackServerContext& context,
                                     const v1::ListRequest& request, v1::JobList& response);

}  // namespace octopair::service
