// Tests connections with TLS, and certificates in place of tokens.
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>
#include <thread>

#include "service/guarded.hpp"

namespace octopair::test {
namespace {

class Tls : public ::testing::Test {
protected:
    static const Certificates& files() {
        static const Certificates made;
        return made;
    }
    static service::ServerOptions secured(const std::string& name, bool clients_too = false) {
        service::ServerOptions options = options_at("127.0.0.1:0");
        options.tls = {files().pem(name), files().key(name), clients_too ? files().pem("authority") : ""};
        return options;
    }
    static ClientOptions trusting(const std::string& name = "") {
        ClientOptions options{.authority = files().pem("authority")};
        if (!name.empty()) options.certificate = files().pem(name);
        if (!name.empty()) options.key = files().key(name);
        return options;
    }
    static std::string failure_of(const std::string& address, const ClientOptions& options) {
        return error_of(ErrorCode::engine_failed, [&] { ask(address, options); });
    }
    static std::string refusal_of(const service::ServerOptions& options, ErrorCode code) {
        return error_of(code, [&] { const service::Server server(options, silent()); });
    }
};

TEST_F(Tls, ClientsFindTheirPairs) {
    const service::Server server(secured("server"), silent());
    EXPECT_EQ(ask(server.address().text(), trusting()), right_answer);
    EXPECT_EQ(ask("localhost:" + server.address().port, trusting()), right_answer);
}

TEST_F(Tls, OtherMachinesMayReachAProtectedServer) {
    service::ServerOptions options = secured("server", true);
    options.listen = service::parse_address("0.0.0.0:0");
    const service::Server server(options, silent());
    EXPECT_EQ(ask("127.0.0.1:" + server.address().port, trusting("client")), right_answer);
    options = secured("server");
    options.listen = service::parse_address("0.0.0.0:0");
    EXPECT_EQ(refusal_of(options, ErrorCode::usage),
              "0.0.0.0:0: other machines can reach it; that needs tokens or an authority for client certificates");
}

TEST_F(Tls, ClientsDoNotTrustEverybody) {
    const service::Server expired(secured("expired-server"), silent()), stranger(secured("stranger"), silent());
    EXPECT_TRUE(has_text(failure_of(expired.address().text(), trusting()), "certificate verify failed"));
    EXPECT_TRUE(has_text(failure_of(stranger.address().text(), trusting()), "certificate verify failed"));
}

TEST_F(Tls, AnExpiredCertificateOfTheServerIsAWarning) {
    for (const auto& [name, warns] : {std::pair("expired-server", true), std::pair("server", false)}) {
        std::ostringstream words;
        const service::Server server(
            secured(name),
            service::make_log(service::LogForm::text, std::make_shared<spdlog::sinks::ostream_sink_mt>(words)));
        EXPECT_EQ(words.str().find(files().pem(name) + ": the certificate has expired") != std::string::npos, warns)
            << words.str();
    }
}

TEST_F(Tls, ClientsShowTheirCertificates) {
    const service::Server server(secured("server", true), silent());
    const std::string address = server.address().text();
    EXPECT_EQ(ask(address, trusting("client")), right_answer);
    for (const std::string name : {"", "expired-client", "stranger"}) {
        EXPECT_TRUE(failure_of(address, trusting(name)).starts_with(address + ": no server answers: ")) << name;
    }
    EXPECT_EQ(ask(address, trusting("client")), right_answer);
}

/// The owner of a job is a name of the client's certificate. A certificate without a name is refused, so such clients do not share jobs.
TEST_F(Tls, CertificatesNameTheirClients) {
    std::ostringstream text;
    const auto log = service::make_log(service::LogForm::json, std::make_shared<spdlog::sinks::ostream_sink_mt>(text));
    log->set_level(spdlog::level::debug);
    const service::Server server(secured("server", true), log);
    const std::string address = server.address().text();
    for (const std::string name : {"nameless", "nameless-too"}) {
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(address, trusting(name)); }),
                  address + ": the certificate names nobody");
    }
    for (const auto& [name, owner] : {std::pair("by-common-name", "certificate:anna"),
                                      {"by-dns", "certificate-dns:anna.example"},
                                      {"by-email", "certificate-email:anna@example.org"},
                                      {"by-uri", "certificate-uri:spiffe://example.org/anna"}}) {
        EXPECT_EQ(ask(address, trusting(name)), right_answer) << name;
        const std::string field = "\"owner\":\"" + std::string(owner) + "\"";
        const auto is_logged = [&] { return text.str().find(field) != std::string::npos; };
        for (int tries = 0; tries < 3000 && !is_logged(); ++tries)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        EXPECT_TRUE(is_logged()) << name << ": " << text.str();
    }
}

TEST_F(Tls, PlainAndEncryptedDoNotMix) {
    const service::Server encrypted(secured("server"), silent()), plain(options_at("127.0.0.1:0"), silent());
    for (const auto& [server, options] : {std::pair(&encrypted, ClientOptions()), std::pair(&plain, trusting())}) {
        const std::string address = server->address().text();
        EXPECT_TRUE(failure_of(address, options).starts_with(address + ": no server answers: "));
    }
    EXPECT_EQ(ask(encrypted.address().text(), trusting()), right_answer);
    EXPECT_EQ(ask(plain.address().text(), {}), right_answer);
}

TEST_F(Tls, FilesThatDoNotFitAreRefused) {
    service::ServerOptions options = secured("server");
    options.tls.key = files().key("client");
    EXPECT_EQ(refusal_of(options, ErrorCode::bad_input),
              files().key("client") + ": is not the key of " + files().pem("server"));
    options.tls.key = "";
    EXPECT_EQ(refusal_of(options, ErrorCode::usage), "a certificate needs its key, and a key its certificate");
    options.tls = {files().key("server"), files().key("server"), ""};
    EXPECT_EQ(refusal_of(options, ErrorCode::bad_input), files().key("server") + ": holds no certificate (PEM)");
    options.tls = {files().pem("server"), files().key("server"), files().key("client")};
    EXPECT_EQ(refusal_of(options, ErrorCode::bad_input), files().key("client") + ": holds no certificate (PEM)");
    options.tls = {"", "", files().pem("authority")};
    EXPECT_EQ(refusal_of(options, ErrorCode::usage),
              "an authority for clients needs a certificate of the server as well");
}

TEST_F(Tls, FilesOfAClientThatDoNotFitAreRefused) {
    const auto refusal = [](const ClientOptions& options) {
        return error_of(ErrorCode::bad_input, [&] { (void)connect("127.0.0.1:1", options); });
    };
    ClientOptions options = trusting("client");
    options.key = files().key("server");
    EXPECT_EQ(refusal(options), files().key("server") + ": is not the key of " + files().pem("client"));
    options.certificate = files().key("client");
    EXPECT_EQ(refusal(options), files().key("client") + ": holds no certificate (PEM)");
    options.authority = files().key("client");
    EXPECT_EQ(refusal(options), files().key("client") + ": holds no certificate (PEM)");
}

/// A server that is told so uses new certificates for new connections. Connections that exist stay.
TEST_F(Tls, CertificatesAreReadAgain) {
    const TemporaryDirectory folder;
    service::ServerOptions options = secured("server", true);
    const auto use = [&](const std::string& certificate, const std::string& key, const std::string& authority) {
        options.tls = {folder.file("certificate"), folder.file("key"), folder.file("authority")};
        write_file(options.tls.certificate, read_file(certificate));
        write_secret(options.tls.key, read_file(key));
        write_file(options.tls.client_authority, read_file(authority));
    };
    use(files().pem("server"), files().key("server"), files().pem("authority"));
    service::Server server(options, silent());
    const std::string address = server.address().text();
    ClientOptions other = trusting("stranger");
    other.authority = files().pem("other");
    const auto earlier = connect(address, trusting("client"));
    const auto gives = [&](const ClientOptions& client) {
        try {
            return ask(address, client) == right_answer;
        } catch (const Error&) {
            return false;
        }
    };
    EXPECT_TRUE(gives(trusting("client")));
    EXPECT_FALSE(gives(other));

    use(files().pem("stranger"), files().key("server"), files().pem("other"));
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { server.reload(); }),
              options.tls.key + ": is not the key of " + options.tls.certificate);
    std::this_thread::sleep_for(std::chrono::seconds(3));
    EXPECT_TRUE(gives(trusting("client"))) << "the old files stay";

    use(files().pem("stranger"), files().key("stranger"), files().pem("other"));
    server.reload();
    bool changed = false;
    for (int tries = 0; tries < 3000 && !changed; ++tries) {
        changed = gives(other);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_TRUE(changed);
    EXPECT_FALSE(gives(trusting("client")));
    const std::vector<Box3f> boxes(3);
    EXPECT_EQ(earlier->count_pairs({boxes}), 3u);
}

TEST_F(Tls, NewRolesAreNotUsedIfACertificateHasAFault) {
    const TemporaryDirectory folder;
    service::ServerOptions options = secured("server");
    options.tls.certificate = folder.file("certificate");
    write_file(options.tls.certificate, read_file(files().pem("server")));
    options.token_file = folder.file("tokens");
    write_secret(options.token_file, "anna anna-0123456789ab\n");
    options.role_file = folder.file("roles");
    write_secret(options.role_file, "");
    service::Server server(options, silent());
    ClientOptions anna = trusting();
    anna.token = "anna-0123456789ab";
    write_secret(options.role_file, "token:anna none\n");
    write_file(options.tls.certificate, "broken");
    (void)error_of(ErrorCode::bad_input, [&] { server.reload(); });
    EXPECT_EQ(ask(server.address().text(), anna), right_answer);
    write_file(options.tls.certificate, read_file(files().pem("server")));
    server.reload();
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(server.address().text(), anna); }),
              server.address().text() + ": the client has no access any more");
}

TEST_F(Tls, KeysOthersMayReadAreRefused) {
    const TemporaryDirectory folder;
    service::ServerOptions options = secured("server");
    options.tls.key = folder.file("key");
    write_secret(options.tls.key, read_file(files().key("server")));
    { const service::Server server(options, silent()); }
    ASSERT_EQ(::chmod(options.tls.key.c_str(), 0644), 0);
    EXPECT_EQ(refusal_of(options, ErrorCode::usage),
              options.tls.key + ": other users can access this secret file; restrict it to its owner (chmod 600)");
}

}  // namespace
}  // namespace octopair::test
