#include "service/server/net/credentials.hpp"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_certificate_verifier.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"
#include "service/protocol/credential_files.hpp"
#include "service/server/log/log_line.hpp"

namespace octopair::service {

Credentials::Copy::Copy() : file_(::memfd_create("octopair-tls", MFD_CLOEXEC)) {
    if (!file_.open()) fail_io("the files of TLS", "cannot copy", errno);
}

std::string Credentials::Copy::path() const { return "/proc/self/fd/" + std::to_string(file_.number()); }

void Credentials::Copy::write(const std::string& text) const {
    const bool written = ::pwrite(file_.number(), text.data(), text.size(), 0) == ssize_t(text.size());
    if (!written || ::ftruncate(file_.number(), off_t(text.size())) != 0)
        fail_io("the files of TLS", "cannot copy", errno);
}

Credentials::Credentials(const ServerTls& tls, spdlog::logger& log) : tls_(tls), log_(log) {
    if (tls.certificate.empty() != tls.key.empty()) {
        throw Error(ErrorCode::usage, "a certificate needs its key, and a key its certificate");
    }
    if (tls.certificate.empty() && !tls.client_authority.empty()) {
        throw Error(ErrorCode::usage, "an authority for clients needs a certificate of the server as well");
    }
    if (tls.certificate.empty()) return;
    copies_.emplace();
    read();
}

// The files are checked here because gRPC would not report any of these errors: it would refuse every client.
void Credentials::read() const {
    const Pem certificate{read_small_file(tls_.certificate), tls_.certificate};
    const Pem key{read_private_file(tls_.key), tls_.key};
    check_key(certificate, key);
    Pem authority;
    if (!tls_.client_authority.empty()) {
        authority = {read_small_file(tls_.client_authority), tls_.client_authority};
        check_certificate(authority);
    }
    if (has_expired(certificate)) {
        log_text(log_, LogLevel::warning, certificate.file + ": the certificate has expired: clients will refuse it");
    }
    copies_->certificate.write(certificate.text);
    copies_->key.write(key.text);
    copies_->client_authority.write(authority.text);
}

void Credentials::reload() {
    if (copies_) read();
}

std::shared_ptr<grpc::ServerCredentials> Credentials::make() const {
    if (!copies_) return nullptr;
    namespace tls = grpc::experimental;
    constexpr unsigned refresh_seconds = 1;
    const bool names_clients = !tls_.client_authority.empty();
    const auto provider = std::make_shared<tls::FileWatcherCertificateProvider>(
        copies_->key.path(), copies_->certificate.path(), names_clients ? copies_->client_authority.path() : "",
        refresh_seconds);
    tls::TlsServerCredentialsOptions options(provider);
    options.watch_identity_key_cert_pairs();
    if (names_clients) {
        options.watch_root_certs();
        options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
        // A client's certificate need not name a host.
        options.set_certificate_verifier(std::make_shared<tls::NoOpCertificateVerifier>());
    }
    return tls::TlsServerCredentials(options);
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
