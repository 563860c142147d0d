#include "service/server/net/credentials.hpp"

#include <grpcpp/security/server_credentials.h>

#include "octopair/error.hpp"
#include "service/protocol/certificate.hpp"
#include "service/protocol/private_file.hpp"
#include "service/server/log/event.hpp"

namespace octopair::service {

// The files are checked here because gRPC would not report any of these errors: it would refuse every client.
std::shared_ptr<grpc::ServerCredentials> credentials_of(const ServerTls& tls, spdlog::logger& log) {
    if (tls.certificate.empty() != tls.key.empty()) {
        throw Error(ErrorCode::usage, "a certificate needs its key, and a key its certificate");
    }
    if (tls.certificate.empty()) {
        if (!tls.client_authority.empty()) {
            throw Error(ErrorCode::usage, "an authority for clients needs a certificate of the server as well");
        }
        return grpc::InsecureServerCredentials();
    }
    const Pem certificate{read_small_file(tls.certificate), tls.certificate};
    const Pem key{read_private_file(tls.key), tls.key};
    check_key(certificate, key);
    if (has_expired(certificate)) {
        log_text(log, LogLevel::warning, certificate.file + ": the certificate has expired: clients will refuse it");
    }
    grpc::SslServerCredentialsOptions options;
    options.pem_key_cert_pairs.push_back({key.text, certificate.text});
    if (!tls.client_authority.empty()) {
        options.pem_root_certs = read_small_file(tls.client_authority);
        check_certificate({options.pem_root_certs, tls.client_authority});
        options.client_certificate_request = GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
    }
    return grpc::SslServerCredentials(options);
}

std::string missing_protection(const ServerOptions& options) {
    const bool known = !options.token_file.empty() || !options.tls.client_authority.empty();
    std::string missing;
    if (options.tls.certificate.empty()) missing = "TLS (a certificate and its key)";
    if (!known)
        missing += std::string(missing.empty() ? "" : ", and ") + "tokens or an authority for client certificates";
    return missing;
}

}  // namespace octopair::service
