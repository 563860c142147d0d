// Checks of certificates and keys (PEM), because the error messages of gRPC do not name the cause.
#pragma once

#include <string>

namespace octopair::service {

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
