#include "service/server/calls/calls.hpp"

#include <string>

#include "octopair/version.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/server/calls/call_handlers.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

using Service = v1::Octopair;
using WithDescribe = Service::WithCallbackMethod_Describe<Service::Service>;
using WithJobCalls =
    Service::WithCallbackMethod_Status<Service::WithCallbackMethod_Wait<Service::WithCallbackMethod_Cancel<
        Service::WithCallbackMethod_Release<Service::WithCallbackMethod_List<WithDescribe>>>>>;
/// Calls whose messages have large fields receive raw bytes: protobuf would copy the large fields.
using WithDetachedCalls = Service::WithRawCallbackMethod_Submit<Service::WithRawCallbackMethod_Result<WithJobCalls>>;
using Methods = Service::WithRawCallbackMethod_Detect<
    Service::WithRawCallbackMethod_DetectSmall<Service::WithRawCallbackMethod_Scene<WithDetachedCalls>>>;

class Calls final : public Methods {
public:
    explicit Calls(ServerContext& server) : server_(server) {}

    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Detect(grpc::CallbackServerContext* context) override {
        return start_detect(server_, *context);
    }
    grpc::ServerUnaryReactor* DetectSmall(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                          grpc::ByteBuffer* response) override {
        return start_detect_small(server_, *context, *request, *response);
    }
    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Scene(grpc::CallbackServerContext* context) override {
        return start_scene(server_, *context);
    }
    grpc::ServerReadReactor<grpc::ByteBuffer>* Submit(grpc::CallbackServerContext* context,
                                                      grpc::ByteBuffer* response) override {
        return start_submit(server_, *context, *response);
    }
    grpc::ServerWriteReactor<grpc::ByteBuffer>* Result(grpc::CallbackServerContext* context,
                                                       const grpc::ByteBuffer* request) override {
        return start_result(server_, *context, *request);
    }
    grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const v1::JobName* request,
                                     v1::JobReport* response) override {
        return start_status(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Wait(grpc::CallbackServerContext* context, const v1::WaitRequest* request,
                                   v1::JobReport* response) override {
        return start_wait(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const v1::JobName* request,
                                     v1::JobReport* response) override {
        return start_cancel(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Release(grpc::CallbackServerContext* context, const v1::JobName* request,
                                      v1::JobReport* response) override {
        return start_release(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const v1::ListRequest* request,
                                   v1::JobList* response) override {
        return start_list(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Describe(grpc::CallbackServerContext* context, const v1::DescribeRequest*,
                                       v1::ServerDescription* description) override {
        std::string owner;
        const grpc::Status status = server_.admit(*context, owner);
        if (status.ok()) describe(*description);
        grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
        reactor->Finish(status);
        return reactor;
    }

private:
    void describe(v1::ServerDescription& description) const {
        const ServerLimits& limits = server_.options.limits;
        description.set_version(OCTOPAIR_VERSION);
        description.set_algorithm(algorithm_version);
        description.set_engine(server_.options.engine_name);
        description.set_detached(!server_.options.state_folder.empty());
        v1::Limits& described = *description.mutable_limits();
        described.set_objects(limits.objects);
        described.set_input_bytes(limits.input_bytes);
        described.set_pairs(limits.pairs);
        described.set_jobs(limits.jobs);
        described.set_jobs_per_client(limits.jobs_per_client);
        described.set_connections(limits.connections);
        described.set_job_seconds(limits.job_seconds);
        described.set_memory_bytes(limits.memory_bytes);
        described.set_state_bytes(limits.state_bytes);
        described.set_message_bytes(max_message_bytes);
    }

    ServerContext& server_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_calls(ServerContext& server) { return std::make_unique<Calls>(server); }

}  // namespace octopair::service
