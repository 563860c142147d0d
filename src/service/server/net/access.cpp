#include "service/server/net/access.hpp"

#include <grpc/grpc_security_constants.h>
#include <grpcpp/server_context.h>
#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <sstream>

#include "octopair/error.hpp"
#include "service/protocol/private_file.hpp"

namespace octopair::service {

namespace {

std::array<unsigned char, 32> digest_of(std::string_view token) {
    std::array<unsigned char, 32> digest{};
    SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
    return digest;
}

[[noreturn]] void refuse(const std::string& file, std::size_t line, const char* why) {
    throw Error(ErrorCode::bad_input, file + ": line " + std::to_string(line) + ": " + why);
}

}  // namespace

Access::Access(const std::string& token_file) {
    if (token_file.empty()) return;
    constexpr std::size_t shortest = 16;
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
        if (std::any_of(tokens_.begin(), tokens_.end(), same))
            refuse(token_file, number, "an earlier line has the same name or token");
        tokens_.push_back({name, digest});
    }
    if (tokens_.empty()) throw Error(ErrorCode::bad_input, token_file + ": the file contains no token");
}

/// Compares with all tokens, each in constant time, so that the time reveals nothing about a token.
const Access::Token* Access::find(std::string_view token) const {
    const Digest digest = digest_of(token);
    const Token* found = nullptr;
    for (const Token& known : tokens_) {
        if (CRYPTO_memcmp(known.digest.data(), digest.data(), digest.size()) == 0) found = &known;
    }
    return found;
}

grpc::Status Access::identify(const grpc::ServerContextBase& context, std::string& owner) const {
    if (has_tokens()) {
        constexpr std::string_view scheme = "Bearer ";
        const auto& metadata = context.client_metadata();
        const auto given = metadata.find("authorization");
        if (given == metadata.end()) return {grpc::StatusCode::UNAUTHENTICATED, "the server requires a token"};
        const std::string_view value(given->second.data(), given->second.size());
        const bool bearer = value.substr(0, scheme.size()) == scheme;
        const Token* const token = bearer ? find(value.substr(scheme.size())) : nullptr;
        if (token == nullptr) return {grpc::StatusCode::UNAUTHENTICATED, "the server does not accept this token"};
        owner = "token:" + token->name;
        return grpc::Status::OK;
    }
    const auto caller = context.auth_context();
    if (caller && caller->IsPeerAuthenticated()) {
        const auto names = caller->FindPropertyValues(GRPC_X509_CN_PROPERTY_NAME);
        if (names.empty()) return {grpc::StatusCode::UNAUTHENTICATED, "the certificate has no common name"};
        owner = "certificate:" + std::string(names.front().data(), names.front().size());
        return grpc::Status::OK;
    }
    owner = "local";
    return grpc::Status::OK;
}

}  // namespace octopair::service
