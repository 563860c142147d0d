// Credentials: TLS of a server's connections, and the check that a server which other machines can reach is protected.
#pragma once

#include <spdlog/fwd.h>

#include <memory>
#include <optional>
#include <string>

#include "base/descriptor.hpp"
#include "service/server/server_options.hpp"

namespace grpc {
class ServerCredentials;
}  // namespace grpc

namespace octopair::service {

class Credentials {
public:
    /// Reads the files of `tls`. Logs a warning if the certificate has expired. Borrows the log.
    /// Throws: Error{usage} for files that do not fit together, Error{bad_input} for a file without a certificate or key; errors of
    /// reading.
    Credentials(const ServerTls& tls, spdlog::logger& log);

    /// Returns gRPC's credentials of TLS; null without a certificate. Requires: this object outlives them.
    std::shared_ptr<grpc::ServerCredentials> make() const;
    /// Reads the files again. Connections that are made more than two seconds later use them. Throws: as the constructor; then nothing
    /// changes.
    void reload();

private:
    /// A file in memory that holds a copy of a file of `tls`. gRPC reads the copy again each second.
    class Copy {
    public:
        Copy();
        std::string path() const;
        void write(const std::string& text) const;

    private:
        Descriptor file_;
    };
    struct Copies {
        Copy certificate, key, client_authority;
    };

    void read() const;

    const ServerTls tls_;
    spdlog::logger& log_;
    std::optional<Copies> copies_;  // empty without a certificate
};

/// Returns, in words, the protection that `options` lack for a server that other machines can reach. Empty: nothing is missing.
std::string missing_protection(const ServerOptions& options);

}  // namespace octopair::service
