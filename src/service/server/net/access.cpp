#include "service/server/net/access.hpp"

#include <grpc/grpc_security_constants.h>
#include <grpcpp/security/auth_context.h>
#include <grpcpp/server_context.h>
#include <openssl/crypto.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

namespace octopair::service {

namespace {

constexpr std::string_view bearer = "bearer ";
const std::string token_client = "token:";  // prefix of the names of clients with tokens

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

/// Sets `name` to the caller's name, or returns why its token is refused.
grpc::Status check_token(const grpc::ServerContextBase& context, const std::vector<Token>& known, std::string& name) {
    const auto& metadata = context.client_metadata();
    const auto given = metadata.find("authorization");
    if (given == metadata.end()) return {grpc::StatusCode::UNAUTHENTICATED, "the server requires a token"};
    const std::string_view value(given->second.data(), given->second.size());
    const TokenDigest digest = digest_of(value.substr(std::min(bearer.size(), value.size())));
    const Token* token = nullptr;
    // All tokens are compared, each in constant time, so that the time reveals nothing about a token.
    for (const Token& one : known) {
        if (CRYPTO_memcmp(one.digest.data(), digest.data(), digest.size()) == 0) token = &one;
    }
    if (token == nullptr || !is_bearer(value))
        return {grpc::StatusCode::UNAUTHENTICATED, "the server does not accept this token"};
    if (token->until && std::chrono::system_clock::now() >= *token->until)
        return {grpc::StatusCode::UNAUTHENTICATED, "the token has expired"};
    name = token_client + token->name;
    return grpc::Status::OK;
}

}  // namespace

Access::Access(std::string token_file, std::string role_file)
    : token_file_(std::move(token_file)), role_file_(std::move(role_file)), files_(read()) {}

std::shared_ptr<const Access::Files> Access::read() const {
    auto files = std::make_shared<Files>();
    if (!token_file_.empty()) files->tokens = read_token_file(token_file_);
    if (!role_file_.empty()) files->roles = Roles(role_file_);
    return files;
}

void Access::use(std::shared_ptr<const Files> files) {
    const std::lock_guard lock(mutex_);
    files_ = std::move(files);
}

std::vector<std::string> Access::clients_without_token() const {
    const std::shared_ptr<const Files> files = this->files();
    std::vector<std::string> without;
    for (const std::string& client : files->roles.clients()) {
        const auto has_name = [&](const Token& token) { return client == token_client + token.name; };
        if (client.starts_with(token_client) && std::ranges::none_of(files->tokens, has_name))
            without.push_back(client);
    }
    return without;
}

std::shared_ptr<const Access::Files> Access::files() const {
    const std::lock_guard lock(mutex_);
    return files_;
}

grpc::Status Access::identify(const grpc::ServerContextBase& context, Caller& caller) const {
    const std::shared_ptr<const Files> files = this->files();
    std::string name = "local";
    if (has_tokens()) {
        grpc::Status status = check_token(context, files->tokens, name);
        if (!status.ok()) return status;
    } else if (const auto peer = context.auth_context(); peer && peer->IsPeerAuthenticated()) {
        name = name_of(*peer);
        if (name.empty()) return {grpc::StatusCode::UNAUTHENTICATED, "the certificate names nobody"};
    }
    caller = files->roles.caller(name);
    if (caller.role == Role::none) return {grpc::StatusCode::UNAUTHENTICATED, "the client has no access any more"};
    return grpc::Status::OK;
}

}  // namespace octopair::service
