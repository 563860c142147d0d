#include "service/server/net/role_file.hpp"

#include <algorithm>
#include <array>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string_view>

#include "octopair/error.hpp"
#include "service/protocol/private_file.hpp"

namespace octopair::service {

namespace {

std::optional<Role> role_from(const std::string& name) {
    constexpr std::array<Role, 4> roles = {Role::owner, Role::reader, Role::server_operator, Role::none};
    for (const Role role : roles) {
        if (name_of(role) == name) return role;
    }
    return {};
}

/// Returns whether `name` has the form of a name that access.hpp gives.
bool is_client(const std::string& name) {
    constexpr std::array<std::string_view, 5> kinds = {
        "token:", "certificate:", "certificate-uri:", "certificate-email:", "certificate-dns:"};
    return name == "local" ||
           std::any_of(kinds.begin(), kinds.end(), [&](std::string_view kind) { return name.starts_with(kind); });
}

}  // namespace

Roles::Roles(const std::string& path) {
    std::istringstream in(read_private_file(path));
    std::size_t number = 0;
    for (std::string text; std::getline(in, text);) {
        ++number;
        const auto refuse = [&](const std::string& why) {
            throw Error(ErrorCode::bad_input, path + ": line " + std::to_string(number) + ": " + why);
        };
        std::istringstream words(text);
        std::string name, role_name, reads, rest;
        if (!(words >> std::quoted(name)) || name.starts_with('#')) continue;
        words >> role_name >> std::quoted(reads) >> rest;
        if (!is_client(name)) refuse("a client's name begins with token: or certificate:, as in the server's log");
        const std::optional<Role> role = role_from(role_name);
        if (!role) refuse("a line must be CLIENT ROLE; roles are owner, reader OWNER, operator and none");
        if ((*role == Role::reader) == reads.empty() || !rest.empty())
            refuse("the role reader needs the name of one owner; other roles have none");
        if (!reads.empty() && !is_client(reads)) refuse("the owner's name begins with token: or certificate:");
        if (!callers_.try_emplace(name, Caller{name, *role, reads}).second)
            refuse("an earlier line has the same client");
    }
}

Caller Roles::caller(const std::string& name) const {
    const auto known = callers_.find(name);
    return known == callers_.end() ? Caller{name} : known->second;
}

}  // namespace octopair::service
