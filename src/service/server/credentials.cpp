#include "service/server/credentials.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "octopair/error.hpp"
#include "service/protocol/private_file.hpp"

namespace octopair::service {

namespace {

using Text = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

Text text_of(const std::string& pem) { return {BIO_new_mem_buf(pem.data(), int(pem.size())), &BIO_free}; }

/// There is nobody to ask for a passphrase.
int no_passphrase(char*, int, int, void*) { return -1; }

[[noreturn]] void refuse(const std::string& file, const char* why) {
    ERR_clear_error();
    throw Error(ErrorCode::bad_input, file + ": " + why);
}

/// The first of the file, which is a server's own.
Certificate certificate_of(const std::string& pem, const std::string& file) {
    Certificate certificate(PEM_read_bio_X509(text_of(pem).get(), nullptr, &no_passphrase, nullptr), &X509_free);
    if (!certificate) refuse(file, "holds no certificate (PEM)");
    return certificate;
}

Key key_of(const std::string& pem, const std::string& file) {
    Key key(PEM_read_bio_PrivateKey(text_of(pem).get(), nullptr, &no_passphrase, nullptr), &EVP_PKEY_free);
    if (!key) refuse(file, "holds no key (PEM, without a passphrase)");
    return key;
}

}  // namespace

// gRPC would tell of none of this, but refuse every client.
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
    const std::string chain = read_small_file(tls.certificate), key = read_private_file(tls.key);
    const Certificate certificate = certificate_of(chain, tls.certificate);
    if (X509_check_private_key(certificate.get(), key_of(key, tls.key).get()) != 1) {
        refuse(tls.key, ("is not the key of " + tls.certificate).c_str());
    }
    if (X509_cmp_current_time(X509_get0_notAfter(certificate.get())) < 0) {
        log.warn("{}: the certificate has expired: clients will refuse it", tls.certificate);
    }
    grpc::SslServerCredentialsOptions options;
    options.pem_key_cert_pairs.push_back({key, chain});
    if (!tls.client_authority.empty()) {
        options.pem_root_certs = read_small_file(tls.client_authority);
        (void)certificate_of(options.pem_root_certs, tls.client_authority);
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
