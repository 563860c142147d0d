#include "service/server/server.hpp"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/impl/server_builder_option.h>

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "octopair/error.hpp"
#include "octopair/version.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/library.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/server/credentials.hpp"
#include "service/server/detect_call.hpp"
#include "service/server/host.hpp"
#include "service/server/job_calls.hpp"
#include "service/server/listener.hpp"
#include "service/server/result_call.hpp"
#include "service/server/scene_call.hpp"
#include "service/server/submit_call.hpp"

namespace octopair::service {

namespace {

using Service = v1::Octopair;
using Stated = Service::WithCallbackMethod_Describe<Service::Service>;
using OfJobs = Service::WithCallbackMethod_Status<Service::WithCallbackMethod_Wait<
    Service::WithCallbackMethod_Cancel<Service::WithCallbackMethod_Release<Service::WithCallbackMethod_List<Stated>>>>>;
/// What has a large field comes as bytes.
using Detached = Service::WithRawCallbackMethod_Submit<Service::WithRawCallbackMethod_Result<OfJobs>>;
using Methods = Service::WithRawCallbackMethod_Detect<
    Service::WithRawCallbackMethod_DetectSmall<Service::WithRawCallbackMethod_Scene<Detached>>>;

class Calls final : public Methods {
public:
    explicit Calls(Host& host) : host_(host) {}

    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Detect(grpc::CallbackServerContext* context) override {
        return start_detect(host_, *context);
    }
    grpc::ServerUnaryReactor* DetectSmall(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                          grpc::ByteBuffer* response) override {
        return start_detect_small(host_, *context, *request, *response);
    }
    grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Scene(grpc::CallbackServerContext* context) override {
        return start_scene(host_, *context);
    }
    grpc::ServerReadReactor<grpc::ByteBuffer>* Submit(grpc::CallbackServerContext* context,
                                                      grpc::ByteBuffer* response) override {
        return start_submit(host_, *context, *response);
    }
    grpc::ServerWriteReactor<grpc::ByteBuffer>* Result(grpc::CallbackServerContext* context,
                                                       const grpc::ByteBuffer* request) override {
        return start_result(host_, *context, *request);
    }
    grpc::ServerUnaryReactor* Status(grpc::CallbackServerContext* context, const v1::JobName* request,
                                     v1::JobReport* response) override {
        return start_status(host_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Wait(grpc::CallbackServerContext* context, const v1::WaitRequest* request,
                                   v1::JobReport* response) override {
        return start_wait(host_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext* context, const v1::JobName* request,
                                     v1::JobReport* response) override {
        return start_cancel(host_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Release(grpc::CallbackServerContext* context, const v1::JobName* request,
                                      v1::JobReport* response) override {
        return start_release(host_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* List(grpc::CallbackServerContext* context, const v1::ListRequest* request,
                                   v1::JobList* response) override {
        return start_list(host_, *context, *request, *response);
    }
    grpc::ServerUnaryReactor* Describe(grpc::CallbackServerContext* context, const v1::DescribeRequest*,
                                       v1::ServerDescription* description) override {
        std::string owner;
        const grpc::Status status = host_.let_in(*context, owner);
        if (status.ok()) describe(*description);
        grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
        reactor->Finish(status);
        return reactor;
    }

private:
    void describe(v1::ServerDescription& description) const {
        const ServerLimits& limits = host_.options.limits;
        description.set_version(OCTOPAIR_VERSION);
        description.set_algorithm(algorithm_version);
        description.set_engine(host_.options.engine_name);
        description.set_detached(!host_.options.state_folder.empty());
        v1::Limits& told = *description.mutable_limits();
        told.set_objects(limits.objects);
        told.set_input_bytes(limits.input_bytes);
        told.set_pairs(limits.pairs);
        told.set_jobs(limits.jobs);
        told.set_jobs_per_client(limits.jobs_per_client);
        told.set_connections(limits.connections);
        told.set_job_seconds(limits.job_seconds);
        told.set_memory_bytes(limits.memory_bytes);
        told.set_state_bytes(limits.state_bytes);
        told.set_message_bytes(most_message_bytes);
    }

    Host& host_;
};

/// What gRPC itself may take for messages on their way.
constexpr std::size_t transport_bytes = std::size_t(256) << 20;

void configure(grpc::ServerBuilder& builder, const ServerOptions& options) {
    const auto greeting = std::min<std::chrono::milliseconds>(std::chrono::seconds(10), options.stall);
    grpc::ResourceQuota quota("octopair");
    quota.Resize(transport_bytes);
    builder.SetResourceQuota(quota);
    builder.SetMaxReceiveMessageSize(int(most_message_bytes));
    builder.SetMaxSendMessageSize(int(most_message_bytes));
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, int(greeting.count()));
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, 300'000);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 60'000);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);  // clients' keepalive
    builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 << 10);
}

/// Reflection tells generic clients which calls there are. It asks no one for a token, so a server with tokens does without.
/// Its library puts it into every server.
class WithoutReflection final : public grpc::ServerBuilderOption {
    void UpdateArguments(grpc::ChannelArguments*) override {}
    void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
        const std::string name = grpc::reflection::ProtoServerReflectionPlugin().name();
        std::erase_if(*plugins, [&](const auto& plugin) { return plugin->name() == name; });
    }
};

}  // namespace

class Server::State {
public:
    State(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
        : listener_(options.listen, missing_protection(options)), host_(options, std::move(log)), calls_(host_) {
        keep_grpc();
        grpc::EnableDefaultHealthCheckService(true);
        grpc::reflection::InitProtoReflectionServerBuilderPlugin();
        grpc::ServerBuilder builder;
        configure(builder, options);
        builder.RegisterService(&calls_);
        if (host_.access.has_tokens()) builder.SetOption(std::make_unique<WithoutReflection>());
        using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
        acceptor_ = builder.experimental().AddExternalConnectionAcceptor(Type::FROM_FD,
                                                                         credentials_of(options.tls, *host_.log));
        server_ = builder.BuildAndStart();
        if (!server_) throw Error(ErrorCode::engine_failed, "gRPC does not start");
        if (options.metrics) show_metrics(*options.metrics);
        listener_.start(
            {options.limits.connections, !options.tls.certificate.empty(),
             [this](Descriptor connection) { hand_over(std::move(connection)); },
             [this] { host_.ledger.connections_refused(host_.options.limits.connections, listener_.refused()); }});
    }

    ~State() {
        host_.ledger.metrics().hide();
        listener_.stop();
        server_->Shutdown(std::chrono::system_clock::now());
        server_->Wait();
    }

    const Address& address() const { return listener_.address(); }
    ServerLoad load() const { return {host_.places.count(), host_.memory.taken(), listener_.connections()}; }

    void drain(std::optional<std::chrono::milliseconds> grace) {
        constexpr std::chrono::milliseconds apart(20);
        host_.draining = true;
        host_.lanes.hold_detached();
        listener_.stop();
        server_->GetHealthCheckService()->SetServingStatus(false);
        // gRPC would wait for all calls: those that upload, and scenes that nobody steps.
        const auto end = std::chrono::steady_clock::now() + grace.value_or(host_.options.grace);
        while (!host_.idle() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(apart);
        server_->Shutdown(std::chrono::system_clock::now());
    }

private:
    void show_metrics(const Address& address) {
        Address shown = address;
        shown.port = std::to_string(host_.ledger.metrics().show(address, [this] { return levels(); }));
        host_.log->info("metrics at http://{}/metrics", shown.text());
    }

    Levels levels() const {
        Levels now;
        now.queue = host_.lanes.waiting();
        now.connections = listener_.connections();
        now.connections_refused = listener_.refused();
        now.memory_bytes = host_.memory.taken();
        if (host_.options.worker_faults) now.worker_faults = host_.lanes.sum(host_.options.worker_faults);
        return now;
    }

    void hand_over(Descriptor connection) {
        grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
        parameters.listener_fd = -1;
        parameters.fd = connection.release();
        acceptor_->HandleNewConnection(&parameters);
    }

    Listener listener_;
    Host host_;
    Calls calls_;
    std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
    std::unique_ptr<grpc::Server> server_;
};

Server::Server(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
    : state_(std::make_unique<State>(options, std::move(log))) {}

Server::~Server() = default;

const Address& Server::address() const { return state_->address(); }

ServerLoad Server::load() const { return state_->load(); }

void Server::drain(std::optional<std::chrono::milliseconds> grace) { state_->drain(grace); }

}  // namespace octopair::service
