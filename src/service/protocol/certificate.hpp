// Certificates and keys (PEM): what is wrong with them, which gRPC would not say.
#pragma once

#include <string>

namespace octopair::service {

/// A text, and the file that it is of.
struct Pem {
    std::string text, file;
};

/// Throws Error{bad_input} if there is no certificate in it.
void check_certificate(const Pem& certificate);
/// Of the first certificate, which is a program's own: throws Error{bad_input} if there is none, or no key without a
/// passphrase, or if the key is another one's.
void check_key(const Pem& certificate, const Pem& key);
/// Of the first certificate.
bool has_expired(const Pem& certificate);

}  // namespace octopair::service
