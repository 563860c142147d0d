#include "service/protocol/credential_files.hpp"

#include <fcntl.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <string_view>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"

namespace octopair::service {

namespace {

Descriptor open_file(const std::string& path) {
    Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.open()) fail_io(path, "cannot open", errno);
    return file;
}

std::string read_all(const Descriptor& file, const std::string& path) {
    constexpr std::size_t most = std::size_t(1) << 20;
    std::string contents;
    std::array<char, 4096> piece{};
    for (;;) {
        const ssize_t got = ::read(file.number(), piece.data(), piece.size());
        if (got == 0) return contents;
        if (got < 0 && errno != EINTR) fail_io(path, "cannot read", errno);
        if (got > 0) contents.append(piece.data(), std::size_t(got));
        if (contents.size() > most) throw Error(ErrorCode::resource_limit, path + ": is larger than 1 MiB");
    }
}

}  // namespace

std::string read_small_file(const std::string& path) { return read_all(open_file(path), path); }

std::string read_private_file(const std::string& path) {
    const Descriptor file = open_file(path);
    struct stat found {};
    if (::fstat(file.number(), &found) != 0) fail_io(path, "cannot read", errno);
    const bool roots = found.st_uid == 0 && ::geteuid() != 0;
    const mode_t others = roots ? S_IWGRP | S_IXGRP | S_IRWXO : S_IRWXG | S_IRWXO;
    if ((found.st_mode & others) != 0) {
        throw Error(ErrorCode::usage,
                    path + ": other users can access this secret file; restrict it to its owner (chmod 600)");
    }
    return read_all(file, path);
}

std::string read_token(const std::string& path) {
    constexpr std::string_view blanks = " \t\r\n";
    std::string token = read_private_file(path);
    token.erase(0, std::min(token.find_first_not_of(blanks), token.size()));
    token.erase(token.find_last_not_of(blanks) + 1);
    const bool printable = std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c <= '~'; });
    if (token.empty() || !printable)
        throw Error(ErrorCode::bad_input, path + ": must hold exactly one token, of printable ASCII characters");
    return token;
}

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
