// Access: who a caller is, and whether it may call.
//
// With tokens a caller is the name of its token; with client certificates the common name of its certificate; else all are
// one, named "local": the address alone keeps others out (a Unix socket of its owner's, or loopback).
#pragma once

#include <array>
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
    /// `token_file`: empty, or of lines "NAME TOKEN"; a line that begins with # is passed over. Throws as read_private_file,
    /// Error{bad_input} for a token of less than 16 bytes, a name or a token that is there twice, or no token at all.
    explicit Access(const std::string& token_file);

    bool has_tokens() const { return !tokens_.empty(); }
    /// Sets `owner`, or says why not. Takes the same time for all tokens that are wrong. Thread-safe.
    grpc::Status identify(const grpc::ServerContextBase& context, std::string& owner) const;

private:
    using Digest = std::array<unsigned char, 32>;
    struct Token {
        std::string name;
        Digest digest;
    };

    const Token* find(std::string_view token) const;

    std::vector<Token> tokens_;
};

}  // namespace octopair::service
