// Credentials: TLS of a server's connections, and the check that a server which other machines can reach is protected.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <string>

#include "service/server/server_options.hpp"

namespace grpc {
class ServerCredentials;
}  // namespace grpc

namespace octopair::service {

/// Returns the TLS credentials, or insecure ones without a certificate. Logs a warning if the certificate has expired.
/// Throws: Error{usage} for files that do not fit together, Error{bad_input} for a file without a certificate or key; errors of
/// reading.
std::shared_ptr<grpc::ServerCredentials> credentials_of(const ServerTls& tls, spdlog::logger& log);

/// Returns, in words, the protection that `options` lack for a server that other machines can reach. Empty: nothing is missing.
std::string missing_protection(const ServerOptions& options);

}  // namespace octopair::service
