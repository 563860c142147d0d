// Access: authenticates callers, names them, and finds their roles.
//
// Name of a caller, which owns its jobs:
//   with tokens                "token:" and the name of its token
//   with client certificates   the first subject alternative name of its certificate, a URI, e-mail address or DNS name in this
//                              order of preference: "certificate-uri:", "certificate-email:" or "certificate-dns:" and the name;
//                              without one, "certificate:" and the common name. A certificate without a name is refused.
//   else                       "local" for all callers; only local users can reach the address (private Unix socket, or loopback)
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "service/server/net/caller.hpp"
#include "service/server/net/role_file.hpp"
#include "service/server/net/token_file.hpp"

namespace grpc {
class ServerContextBase;
class Status;
}  // namespace grpc

namespace octopair::service {

class Access {
public:
    /// Paths of a token file and a role file (token_file.hpp, role_file.hpp); empty: none. Throws: as reading them.
    Access(std::string token_file, std::string role_file);

    struct Files {
        std::vector<Token> tokens;
        Roles roles;
    };
    /// Reads the files again. Throws: as the constructor.
    std::shared_ptr<const Files> read() const;
    /// Replaces the tokens and roles in use by `files`, which read() returned. Thread safety: any thread may call it.
    void use(std::shared_ptr<const Files> files);
    /// Returns the clients "token:NAME" of the role file for which no token has this name. Thread safety: any thread may call it.
    std::vector<std::string> clients_without_token() const;
    bool has_tokens() const { return !token_file_.empty(); }
    /// Sets `caller` to the authenticated caller, or returns why the caller is refused. Takes the same time for every wrong token.
    /// Thread safety: any thread may call it.
    grpc::Status identify(const grpc::ServerContextBase& context, Caller& caller) const;

private:
    std::shared_ptr<const Files> files() const;

    const std::string token_file_, role_file_;
    mutable std::mutex mutex_;
    std::shared_ptr<const Files> files_;
};

}  // namespace octopair::service
