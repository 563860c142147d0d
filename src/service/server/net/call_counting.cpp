#include "service/server/net/call_counting.hpp"

#include <grpc/grpc_security.h>
#include <grpcpp/security/auth_context.h>
#include <grpcpp/security/auth_metadata_processor.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_context.h>

#include <atomic>
#include <charconv>
#include <string>
#include <string_view>

#include "service/protocol/octopair.grpc.pb.h"
#include "service/server/net/insecure_credentials.hpp"
#include "service/server/net/listener.hpp"

namespace octopair::service {

namespace {

/// Property of a connection's authentication context: the connection's number.
constexpr const char* number_property = "octopair_connection";
const std::string service_path = std::string("/") + v1::Octopair::service_full_name() + "/";
constexpr const char* refusal = "the connection has reset too many calls";

std::string next_number() {
    static std::atomic<std::uint64_t> last = 0;
    return std::to_string(++last);
}

/// Returns 0 for a text that is not a number.
std::uint64_t number_in(std::string_view text) {
    std::uint64_t number = 0;
    (void)std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

std::uint64_t number_of(const grpc::AuthContext& context) {
    const std::vector<grpc::string_ref> values = context.FindPropertyValues(number_property);
    return values.empty() ? 0 : number_in({values.front().data(), values.front().size()});
}

/// Counts the begins of calls over TLS.
class TlsProcessor final : public grpc::AuthMetadataProcessor {
public:
    explicit TlsProcessor(Listener& listener) : listener_(listener) {}

    bool IsBlocking() const override { return false; }
    grpc::Status Process(const InputMetadata&, grpc::AuthContext* context, OutputMetadata*, OutputMetadata*) override {
        if (number_of(*context) == 0) context->AddProperty(number_property, next_number());
        if (listener_.note_begin(number_of(*context))) return grpc::Status::OK;
        return {grpc::StatusCode::UNAVAILABLE, refusal};
    }

private:
    Listener& listener_;
};

/// Counts the begins of calls without TLS.
// NOLINTNEXTLINE(readability-function-size): gRPC's parameters.
void process_insecure(void* listener, grpc_auth_context* context, const grpc_metadata*, std::size_t,
                      grpc_process_auth_metadata_done_cb done, void* call) {
    const auto find_number = [&]() -> std::uint64_t {
        auto properties = grpc_auth_context_find_properties_by_name(context, number_property);
        const grpc_auth_property* const found = grpc_auth_property_iterator_next(&properties);
        return found == nullptr ? 0 : number_in({found->value, found->value_length});
    };
    if (find_number() == 0) grpc_auth_context_add_cstring_property(context, number_property, next_number().c_str());
    const bool good = static_cast<Listener*>(listener)->note_begin(find_number());
    done(call, nullptr, 0, nullptr, 0, good ? GRPC_STATUS_OK : GRPC_STATUS_UNAVAILABLE, good ? nullptr : refusal);
}

/// Counts the end of a call in its destructor. gRPC makes one for each call, and destroys it with the call.
class CountedCall final : public grpc::experimental::Interceptor {
public:
    CountedCall(grpc::experimental::ServerRpcInfo& call, Listener& listener)
        : call_(call), listener_(listener), connection_(CallCounting::connection_of(*call.server_context())) {}
    ~CountedCall() override { listener_.note_end(connection_, reset_); }

    void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
        using Point = grpc::experimental::InterceptionHookPoints;
        if (methods->QueryInterceptionHookPoint(Point::POST_RECV_CLOSE) && is_own())
            reset_ = call_.server_context()->IsCancelled();
        methods->Proceed();
    }

private:
    /// Returns whether the call is one of octopair's. For calls of gRPC's own services that block a thread (reflection), IsCancelled()
    /// would call Intercept() without end.
    bool is_own() const { return std::string_view(call_.method()).starts_with(service_path); }

    grpc::experimental::ServerRpcInfo& call_;
    Listener& listener_;
    const std::uint64_t connection_;
    bool reset_ = false;
};

class CountedCalls final : public grpc::experimental::ServerInterceptorFactoryInterface {
public:
    explicit CountedCalls(Listener& listener) : listener_(listener) {}

    grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* call) override {
        return new CountedCall(*call, listener_);
    }

private:
    Listener& listener_;
};

}  // namespace

std::shared_ptr<grpc::ServerCredentials> CallCounting::insecure_credentials() {
    return std::make_shared<InsecureCredentials<grpc::ServerCredentials>>(
        grpc_auth_metadata_processor{.process = process_insecure, .destroy = nullptr, .state = &listener_});
}

void CallCounting::count_in(grpc::ServerCredentials& credentials) {
    credentials.SetAuthMetadataProcessor(std::make_shared<TlsProcessor>(listener_));
}

std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> CallCounting::interceptors() {
    std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> all;
    all.push_back(std::make_unique<CountedCalls>(listener_));
    return all;
}

std::uint64_t CallCounting::connection_of(const grpc::ServerContextBase& call) {
    const auto context = call.auth_context();
    return context == nullptr ? 0 : number_of(*context);
}

}  // namespace octopair::service
