// InsecureCredentials: credentials of a server without TLS that pass the begin of each call to a processor.
//
// gRPC's C++ interface has processors only for secure credentials, so this file uses gRPC's C interface. InsecureCredentials derives from
// grpc::ServerCredentials, which has two forms:
// - In gRPC 1.51 ServerCredentials has no members, and a derived class binds the ports.
// - In later versions ServerCredentials owns credentials in C, which its constructor takes, and binds the ports with them.
#pragma once

#include <grpc/grpc.h>
#include <grpc/grpc_security.h>
#include <grpcpp/security/auth_metadata_processor.h>

#include <memory>
#include <string>

namespace octopair::service {

/// Returns credentials of gRPC's C interface that call `processor` at the begin of each call. The caller must release them.
inline grpc_server_credentials* make_insecure_credentials(const grpc_auth_metadata_processor& processor) {
    grpc_server_credentials* const credentials = grpc_insecure_server_credentials_create();
    grpc_server_credentials_set_auth_metadata_processor(credentials, processor);
    return credentials;
}

/// Detects whether `Base` (grpc::ServerCredentials) is of a version that owns credentials of gRPC's C interface.
template <typename Base>
class CredentialsForm : public Base {
public:
    static constexpr bool owns_credentials() {
        return requires(const CredentialsForm& form) { form.c_creds(); };
    }
};

/// Insecure credentials for gRPC 1.51.
template <typename Base, bool owns_credentials = CredentialsForm<Base>::owns_credentials()>
class InsecureCredentials final : public Base {
public:
    explicit InsecureCredentials(const grpc_auth_metadata_processor& processor) : processor_(processor) {}

    void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>&) override {}

private:
    int AddPortToServer(const std::string& address, grpc_server* server) override {
        grpc_server_credentials* const credentials = make_insecure_credentials(processor_);
        const int port = grpc_server_add_http2_port(server, address.c_str(), credentials);
        grpc_server_credentials_release(credentials);
        return port;
    }

    grpc_auth_metadata_processor processor_;
};

/// Insecure credentials for later versions of gRPC.
template <typename Base>
class InsecureCredentials<Base, true> final : public Base {
public:
    explicit InsecureCredentials(const grpc_auth_metadata_processor& processor)
        : Base(make_insecure_credentials(processor)) {}

    void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>&) override {}
};

}  // namespace octopair::service
