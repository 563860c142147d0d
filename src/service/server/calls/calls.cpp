// The gRPC service of octopair.proto. It forwards each call to its function (call_handlers.hpp).
#include "service/protocol/octopair.grpc.pb.h"
#include "service/server/calls/call_handlers.hpp"

namespace octopair::service {

namespace {

using Service = v1::Octopair;
template <typename Base>
using WithStreams = Service::WithRawCallbackMethod_Detect<Service::WithRawCallbackMethod_Scene<
    Service::WithRawCallbackMethod_Submit<Service::WithRawCallbackMethod_Result<Base>>>>;
template <typename Base>
using WithJobCalls =
    Service::WithRawCallbackMethod_Status<Service::WithRawCallbackMethod_Wait<Service::WithRawCallbackMethod_Cancel<
        Service::WithRawCallbackMethod_Release<Service::WithRawCallbackMethod_List<Base>>>>>;
template <typename Base>
using WithWatchCalls = Service::WithRawCallbackMethod_ListScenes<Service::WithRawCallbackMethod_WatchScene<Base>>;
template <typename Base>
using WithServerCalls = Service::WithRawCallbackMethod_Describe<Service::WithRawCallbackMethod_Drain<Base>>;
/// All calls receive raw bytes. Protobuf would copy the large fields; and gRPC would answer INTERNAL to messages that cannot be parsed,
/// before the caller is authenticated.
using Methods = WithStreams<
    WithJobCalls<WithWatchCalls<WithServerCalls<Service::WithRawCallbackMethod_DetectSmall<Service::Service>>>>>;

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
    grpc::ServerUnaryReactor* Describe(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                       grpc::ByteBuffer* response) override {
        return start_describe(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                     grpc::ByteBuffer* response) override {
        return start_status(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Wait(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                   grpc::ByteBuffer* response) override {
        return start_wait(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                     grpc::ByteBuffer* response) override {
        return start_cancel(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Release(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                      grpc::ByteBuffer* response) override {
        return start_release(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                   grpc::ByteBuffer* response) override {
        return start_list(server_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* ListScenes(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                         grpc::ByteBuffer* response) override {
        return start_list_scenes(server_, *context, *request, *response);
    }
    grpc::ServerWriteReactor<grpc::ByteBuffer>* WatchScene(grpc::CallbackServerContext* context,
                                                           const grpc::ByteBuffer* request) override {
        return start_watch_scene(server_, *context, *request);
    }
    grpc::ServerUnaryReactor* Drain(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                    grpc::ByteBuffer* response) override {
        return start_drain(server_, *context, *request, *response);
    }

private:
    ServerContext& server_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_calls(ServerContext& server) { return std::make_unique<Calls>(server); }

}  // namespace octopair::service
