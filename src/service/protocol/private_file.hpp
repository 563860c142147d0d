// Files that are read whole: certificates, and secrets, which others must not be able to read.
#pragma once

#include <string>

namespace octopair::service {

/// Throws Error{io_failed} if it cannot be read; Error{resource_limit} for more than a MiB, which none of them has.
std::string read_small_file(const std::string& path);

/// The same of a secret. Throws Error{usage} if others than its owner may read or change it; the group may read it if it
/// belongs to root and its reader is another (as PostgreSQL has it): so an administrator gives it to a service.
std::string read_private_file(const std::string& path);

/// The token in a file that holds nothing else. Throws as read_private_file, and Error{bad_input} if there is no token or
/// more than one.
std::string read_token(const std::string& path);

}  // namespace octopair::service
