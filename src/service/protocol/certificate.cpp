#include "service/protocol/certificate.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

#include "octopair/error.hpp"

namespace octopair::service {

namespace {

using Text = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

Text text_of(const Pem& pem) { return {BIO_new_mem_buf(pem.text.data(), int(pem.text.size())), &BIO_free}; }

/// Refuses keys with a passphrase, because no user can be asked for it.
int no_passphrase(char*, int, int, void*) { return -1; }

[[noreturn]] void refuse(const Pem& pem, const std::string& why) {
    ERR_clear_error();
    throw Error(ErrorCode::bad_input, pem.file + ": " + why);
}

Certificate certificate_of(const Pem& pem) {
    Certificate certificate(PEM_read_bio_X509(text_of(pem).get(), nullptr, &no_passphrase, nullptr), &X509_free);
    if (!certificate) refuse(pem, "holds no certificate (PEM)");
    return certificate;
}

Key key_of(const Pem& pem) {
    Key key(PEM_read_bio_PrivateKey(text_of(pem).get(), nullptr, &no_passphrase, nullptr), &EVP_PKEY_free);
    if (!key) refuse(pem, "holds no key (PEM, without a passphrase)");
    return key;
}

}  // namespace

void check_certificate(const Pem& certificate) { (void)certificate_of(certificate); }

void check_key(const Pem& certificate, const Pem& key) {
    if (X509_check_private_key(certificate_of(certificate).get(), key_of(key).get()) == 1) return;
    refuse(key, "is not the key of " + certificate.file);
}

bool has_expired(const Pem& certificate) {
    return X509_cmp_current_time(X509_get0_notAfter(certificate_of(certificate).get())) < 0;
}

}  // namespace octopair::service
