// Access: authenticates callers and names them.
//
// Name of a caller, which owns its jobs:
//   with tokens                "token:" and the name of its token
//   with client certificates   the first subject alternative name of its certificate, a URI, e-mail address or DNS name in this
//                              order of preference: "certificate-uri:", "certificate-email:" or "certificate-dns:" and the name;
//                              without one, "certificate:" and the common name. A certificate without a name is refused.
//   else                       "local" for all callers; the address limits them (private Unix socket, or loopback)
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace grpc {
class ServerContextBase;
class Status;
}  // namespace grpc

namespace octopair::service {

class Access {
public:
    /// `token_file`: path of a file with lines "NAME TOKEN", in which lines that begin with # are comments; empty: no tokens.
    /// Throws: as read_private_file; Error{bad_input} for an invalid line, a token of less than 16 bytes, a duplicate name or
    /// token, or a file without tokens.
    explicit Access(std::string token_file);

    /// Reads the token file again. Calls that are admitted later need one of its tokens. Throws: as the constructor; the tokens then stay.
    /// Thread safety: safe.
    void reload();
    bool has_tokens() const { return !token_file_.empty(); }
    /// Sets `owner` to the caller's name, or returns why the caller is refused. Takes the same time for every wrong token.
    /// Thread safety: safe.
    grpc::Status identify(const grpc::ServerContextBase& context, std::string& owner) const;

private:
    using Digest = std::array<unsigned char, 32>;
    struct Token {
        std::string name;
        Digest digest;
    };

    using Tokens = std::vector<Token>;

    static Tokens read(const std::string& token_file);
    std::shared_ptr<const Tokens> tokens() const;

    const std::string token_file_;
    mutable std::mutex mutex_;
    std::shared_ptr<const Tokens> tokens_;
};

}  // namespace octopair::service
