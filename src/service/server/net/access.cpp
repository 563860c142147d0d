#include "service/server/net/access.hpp"

#include <grpc/grpc_security_constants.h>
#include <grpcpp/security/auth_context.h>
#include <grpcpp/server_context.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/private_file.hpp"

namespace octopair::service {

namespace {

std::array<unsigned char, 32> digest_of(std::string_view token) {
    std::array<unsigned char, 32> digest{};
    SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
    return digest;
}

constexpr std::string_view bearer = "bearer ";

/// Returns whether credentials have the scheme Bearer, in any case (RFC 9110).
bool is_bearer(std::string_view credentials) {
    const auto same = [](char given, char lower) {
        return (given >= 'A' && given <= 'Z' ? given + 32 : given) == lower;
    };
    return credentials.size() > bearer.size() && std::equal(bearer.begin(), bearer.end(), credentials.begin(),
                                                            [&](char lower, char c) { return same(c, lower); });
}

/// Returns the name of an authenticated peer (access.hpp). Empty: its certificate has no name.
std::string name_of(const grpc::AuthContext& peer) {
    constexpr std::array<std::pair<const char*, const char*>, 4> kinds = {
        {{GRPC_PEER_URI_PROPERTY_NAME, "certificate-uri:"},
         {GRPC_PEER_EMAIL_PROPERTY_NAME, "certificate-email:"},
         {GRPC_PEER_DNS_PROPERTY_NAME, "certificate-dns:"},
         {GRPC_X509_CN_PROPERTY_NAME, "certificate:"}}};
    for (const auto& [property, kind] : kinds) {
        for (const grpc::string_ref& name : peer.FindPropertyValues(property)) {
            if (!name.empty()) return kind + std::string(name.data(), name.size());
        }
    }
    return {};
}

[[noreturn]] void refuse(const std::string& file, std::size_t line, const char* why) {
    throw Error(ErrorCode::bad_input, file + ": line " + std::to_string(line) + ": " + why);
}

}  // namespace

Access::Access(std::string token_file) : token_file_(std::move(token_file)) { reload(); }

void Access::reload() {
    if (token_file_.empty()) return;
    auto tokens = std::make_shared<const Tokens>(read(token_file_));
    const std::lock_guard lock(mutex_);
    tokens_ = std::move(tokens);
}

std::shared_ptr<const Access::Tokens> Access::tokens() const {
    const std::lock_guard lock(mutex_);
    return tokens_;
}

Access::Tokens Access::read(const std::string& token_file) {
    constexpr std::size_t shortest = 16;
    Tokens tokens;
    std::istringstream in(read_private_file(token_file));
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        std::istringstream words(line);
        std::string name, token, rest;
        if (!(words >> name) || name.front() == '#') continue;
        if (!(words >> token) || words >> rest) refuse(token_file, number, "a line must be NAME TOKEN");
        if (!std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c <= '~'; }))
            refuse(token_file, number, "a token must consist of printable ASCII characters");
        if (token.size() < shortest) refuse(token_file, number, "a token must have at least 16 bytes");
        const Digest digest = digest_of(token);
        const auto same = [&](const Token& known) { return known.name == name || known.digest == digest; };
        if (std::any_of(tokens.begin(), tokens.end(), same))
            refuse(token_file, number, "an earlier line has the same name or token");
        tokens.push_back({name, digest});
    }
    if (tokens.empty()) throw Error(ErrorCode::bad_input, token_file + ": the file contains no token");
    return tokens;
}

grpc::Status Access::identify(const grpc::ServerContextBase& context, std::string& owner) const {
    if (has_tokens()) {
        const auto& metadata = context.client_metadata();
        const auto given = metadata.find("authorization");
        if (given == metadata.end()) return {grpc::StatusCode::UNAUTHENTICATED, "the server requires a token"};
        const std::string_view value(given->second.data(), given->second.size());
        const std::shared_ptr<const Tokens> known = tokens();
        const Digest digest = digest_of(value.substr(std::min(bearer.size(), value.size())));
        const Token* token = nullptr;
        // All tokens are compared, each in constant time, so that the time reveals nothing about a token.
        for (const Token& one : *known) {
            if (CRYPTO_memcmp(one.digest.data(), digest.data(), digest.size()) == 0) token = &one;
        }
        if (token == nullptr || !is_bearer(value))
            return {grpc::StatusCode::UNAUTHENTICATED, "the server does not accept this token"};
        owner = "token:" + token->name;
        return grpc::Status::OK;
    }
    const auto caller = context.auth_context();
    if (caller && caller->IsPeerAuthenticated()) {
        owner = name_of(*caller);
        if (owner.empty()) return {grpc::StatusCode::UNAUTHENTICATED, "the certificate names nobody"};
        return grpc::Status::OK;
    }
    owner = "local";
    return grpc::Status::OK;
}

}  // namespace octopair::service
