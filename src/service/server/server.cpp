#include "service/server/server.hpp"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/service_type.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/work_queue.hpp"
#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/grpc_lifetime.hpp"
#include "service/protocol/messages.hpp"
#include "service/server/calls/call_handlers.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/net/call_counting.hpp"
#include "service/server/net/credentials.hpp"
#include "service/server/net/listener.hpp"
#include "service/server/server_context.hpp"

namespace octopair::service {

namespace {

/// Maximum memory of gRPC for messages in transit.
constexpr std::size_t transport_bytes = std::size_t(256) << 20;

void configure(grpc::ServerBuilder& builder, const ServerOptions& options) {
    const auto greeting = std::min<std::chrono::milliseconds>(std::chrono::seconds(10), options.stall);
    grpc::ResourceQuota quota("octopair");
    quota.Resize(transport_bytes);
    builder.SetResourceQuota(quota);
    builder.SetMaxReceiveMessageSize(int(max_message_bytes));
    builder.SetMaxSendMessageSize(int(max_message_bytes));
    // Compressed messages would be expanded before the caller is known.
    for (const auto algorithm : {GRPC_COMPRESS_DEFLATE, GRPC_COMPRESS_GZIP})
        builder.SetCompressionAlgorithmSupportStatus(algorithm, false);
    builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 256);
    builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, int(greeting.count()));
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, 300'000);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 60'000);
    builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 10'000);  // clients' keepalive
    // Answering a flood of pings costs less than refusing it: gRPC collects an error for each ping beyond the limit.
    builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, 0);
    builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 << 10);
    // gRPC handles the calls of a read only after the whole read. A read of 4 MiB, the default size, may begin 15,000 calls.
    builder.AddChannelArgument(GRPC_ARG_TCP_MAX_READ_CHUNK_SIZE, 64 << 10);
}

/// Removes gRPC's reflection from a server with tokens: reflection lists the calls of the server to clients without a token.
/// The reflection library adds itself to every server.
class WithoutReflection final : public grpc::ServerBuilderOption {
    void UpdateArguments(grpc::ChannelArguments*) override {}
    void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
        const std::string name = grpc::reflection::ProtoServerReflectionPlugin().name();
        std::erase_if(*plugins, [&](const auto& plugin) { return plugin->name() == name; });
    }
};

}  // namespace

class Server::Impl {
public:
    Impl(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
        : listener_(options.listen, options.listen_socket, missing_protection(options)),
          context_(options, std::move(log)),
          credentials_(options.tls, *context_.log),
          calls_(make_calls(context_)) {
        keep_grpc();
        grpc::EnableDefaultHealthCheckService(true);
        grpc::reflection::InitProtoReflectionServerBuilderPlugin();
        grpc::ServerBuilder builder;
        configure(builder, options);
        builder.RegisterService(calls_.get());
        if (context_.access.has_tokens()) builder.SetOption(std::make_unique<WithoutReflection>());
        using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
        acceptor_ = builder.experimental().AddExternalConnectionAcceptor(Type::FROM_FD, make_credentials());
        builder.experimental().SetInterceptorCreators(call_counting_.interceptors());
        server_ = builder.BuildAndStart();
        if (!server_) throw Error(ErrorCode::engine_failed, "cannot start the gRPC server");
        if (options.metrics) show_metrics(*options.metrics);
        context_.on_call = [this](const grpc::ServerContextBase& call, const std::string& client) {
            if (listener_.awaits_calls()) count_connection(call, client);
        };
        context_.on_unknown = [this](const std::string& peer) { listener_.note_refused(peer); };
        start_listening(options);
        warn_of_clients_without_token();
    }

    ~Impl() {
        context_.server_log.metrics().hide();
        listener_.stop();
        new_connections_.close();
        handing_over_.clear();
        server_->Shutdown(std::chrono::system_clock::now());
        server_->Wait();
    }

    const Address& address() const { return listener_.address(); }
    ServerLoad load() const { return {context_.job_slots.taken(), context_.memory.taken(), listener_.connections()}; }

    std::uint64_t beats() const { return context_.watchdog.beats(); }

    void reload() {
        auto files = context_.access.read();
        credentials_.reload();
        context_.access.use(std::move(files));  // last: if reload() above throws, tokens and roles are unchanged
        warn_of_clients_without_token();
    }

    void drain(std::optional<std::chrono::milliseconds> grace) {
        constexpr std::chrono::milliseconds apart(20);
        context_.draining = true;
        context_.scheduler.hold_detached();
        listener_.stop();
        server_->GetHealthCheckService()->SetServingStatus(false);
        // Shutdown is called only after this wait: with a deadline, gRPC would wait also for uploads and for idle scenes.
        const auto end = std::chrono::steady_clock::now() + grace.value_or(context_.options.grace);
        while (!context_.idle() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(apart);
        server_->Shutdown(std::chrono::system_clock::now());
    }

private:
    std::shared_ptr<grpc::ServerCredentials> make_credentials() {
        auto tls = credentials_.make();
        if (!tls) return call_counting_.insecure_credentials();
        call_counting_.count_in(*tls);
        return tls;
    }

    void start_listening(const ServerOptions& options) {
        ListenerOptions listening;
        listening.max_connections = options.limits.connections;
        listening.max_per_client = context_.connections_per_client;
        listening.encrypted = !options.tls.certificate.empty();
        listening.accept = [this](Descriptor connection) { new_connections_.add(std::move(connection)); };
        listening.refused = [this] {
            context_.server_log.connections_refused(context_.options.limits.connections, listener_.refused());
        };
        listening.connected = [this](const std::string& peer) { context_.server_log.connected(peer, {}); };
        listening.greeting = std::min<std::chrono::milliseconds>(std::chrono::seconds(10), options.stall);
        try {
            for (std::size_t i = 0; i < max_handed_over; ++i) {
                handing_over_.emplace_back([this] {
                    new_connections_.run([this](Descriptor& connection) { hand_over(std::move(connection)); });
                });
            }
            listener_.start(std::move(listening));
        } catch (...) {
            new_connections_.close();  // ends the threads, which the destructor joins
            throw;
        }
    }

    /// Warns of lines of the role file that have no effect, perhaps because of a misspelt name.
    void warn_of_clients_without_token() const {
        for (const std::string& client : context_.access.clients_without_token())
            log_text(*context_.log, LogLevel::warning, "roles: no token has the name of the client " + client);
    }

    /// Throws: LimitError if the client has too many connections.
    void count_connection(const grpc::ServerContextBase& call, const std::string& client) {
        const std::string peer = call.peer();
        switch (listener_.make_known(peer, {client, CallCounting::connection_of(call)})) {
            case ConnectionWatch::Admission::known_before:
                return;
            case ConnectionWatch::Admission::known_now:
                return context_.server_log.connected(peer, client);
            case ConnectionWatch::Admission::paused:
                throw LimitError("resets", 0,
                                 "resets: the client has reset too many calls; it may connect again in a second");
            case ConnectionWatch::Admission::too_many:
                break;
        }
        const std::uint64_t most = context_.connections_per_client;
        throw LimitError("connections_per_client", most,
                         "connections_per_client: a client may have " + std::to_string(most) + " connections");
    }

    void show_metrics(const Address& address) {
        Address shown = address;
        shown.port = std::to_string(context_.server_log.metrics().show(address, [this] { return levels(); }));
        log_text(*context_.log, LogLevel::info, "metrics at http://" + shown.text() + "/metrics");
    }

    Levels levels() const {
        Levels now;
        now.queue = context_.scheduler.waiting();
        now.connections = listener_.connections();
        now.connections_refused = listener_.refused();
        now.memory_bytes = context_.memory.taken();
        if (context_.options.worker_faults) now.worker_faults = context_.scheduler.sum(context_.options.worker_faults);
        return now;
    }

    void hand_over(Descriptor connection) {
        grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters parameters;
        parameters.listener_fd = -1;
        parameters.fd = connection.release();
        acceptor_->HandleNewConnection(&parameters);
    }

    /// Threads that hand connections to gRPC. gRPC may read on such a thread until the connection has no more data, so it must not be the
    /// listener's, which cuts connections.
    static constexpr std::size_t max_handed_over = 4;

    Listener listener_;
    WorkQueue<Descriptor> new_connections_;
    std::vector<std::jthread> handing_over_;
    ServerContext context_;
    Credentials credentials_;
    CallCounting call_counting_{listener_};
    const std::unique_ptr<grpc::Service> calls_;
    std::unique_ptr<grpc::experimental::ExternalConnectionAcceptor> acceptor_;
    std::unique_ptr<grpc::Server> server_;
};

Server::Server(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
    : impl_(std::make_unique<Impl>(options, std::move(log))) {}

Server::~Server() = default;

const Address& Server::address() const { return impl_->address(); }

ServerLoad Server::load() const { return impl_->load(); }

std::uint64_t Server::beats() const { return impl_->beats(); }

void Server::reload() { impl_->reload(); }

void Server::drain(std::optional<std::chrono::milliseconds> grace) { impl_->drain(grace); }

}  // namespace octopair::service
