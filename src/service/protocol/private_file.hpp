// Reads small files: certificates, and secrets, which other users must not be able to read.
#pragma once

#include <string>

namespace octopair::service {

/// Returns the contents of a file. Throws: Error{io_failed} if it cannot be read; Error{resource_limit} for more than 1 MiB.
std::string read_small_file(const std::string& path);

/// Returns the contents of a secret file. If root owns the file and another user reads it, the group may have read permission
/// (PostgreSQL has the same rule): in this way, an administrator gives a secret to a service.
/// Throws: as read_small_file(); Error{usage} if users other than the owner have more permissions.
std::string read_private_file(const std::string& path);

/// Returns the token of a secret file. Throws: as read_private_file(); Error{bad_input} unless the file has exactly one token.
std::string read_token(const std::string& path);

}  // namespace octopair::service
