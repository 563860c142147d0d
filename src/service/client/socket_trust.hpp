// Checks that no other user can listen at a Unix socket in the server's place, and so receive a client's token.
#pragma once

#include <string>

namespace octopair::service {

/// Checks a socket and all folders above it. Trusted are this user, root, and `server_user` (a name or number; empty: nobody else). The
/// socket and the folders must belong to trusted users. Other users must not be able to write to the socket's folder, nor to
/// folders above it, unless these are sticky, like /tmp. The socket need not exist.
/// Throws: Error{usage} that names the folder or socket, or an unknown user.
void check_socket_trust(const std::string& path, const std::string& server_user);

}  // namespace octopair::service
