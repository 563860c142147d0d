// Reads and checks the files of credentials: secrets, which other users must not be able to read, certificates and keys (PEM).
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

// Checks of certificates and keys, because the error messages of gRPC do not name the cause.

/// Contents of a PEM file, and the name of the file for messages.
struct Pem {
    std::string text, file;
};

/// Throws: Error{bad_input} if the file has no certificate.
void check_certificate(const Pem& certificate);
/// Checks `key` against the first certificate of the file, which is the program's own.
/// Throws: Error{bad_input} if there is no certificate, no key without a passphrase, or the key is of another certificate.
void check_key(const Pem& certificate, const Pem& key);
/// Returns whether the first certificate of the file has expired.
bool has_expired(const Pem& certificate);

}  // namespace octopair::service
