// What protects a server's connections: TLS, and what must be there before others than this machine may connect.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <string>

#include "service/server/server_options.hpp"

namespace grpc {
class ServerCredentials;
}  // namespace grpc

namespace octopair::service {

/// Without a certificate: none. Warns of a certificate that has ended. Throws Error{usage} for files that do not fit
/// together, Error{bad_input} for one that holds no certificate or key, and what reading them throws.
std::shared_ptr<grpc::ServerCredentials> credentials_of(const ServerTls& tls, spdlog::logger& log);

/// What is missing before other machines may reach the server, in words; empty: nothing.
std::string missing_protection(const ServerOptions& options);

}  // namespace octopair::service
