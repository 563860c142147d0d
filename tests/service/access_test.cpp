// Tests access to a server: tokens, token files, and addresses that other machines can reach.
#include <filesystem>

#include "service/guarded.hpp"
#include "service/protocol/credential_files.hpp"
#include "service/protocol/grpc_lifetime.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/server/net/insecure_credentials.hpp"

namespace octopair::test {
namespace {

constexpr const char* right = "0123456789abcdef";
constexpr const char* wrong_token = "0123456789abcdeg";

class Access : public ::testing::Test {
protected:
    Access() { write_secret(folder_.file("tokens"), "# who\nanna 0123456789abcdef\n\nbert fedcba9876543210\n"); }

    service::ServerOptions with_tokens(const std::string& address) const {
        service::ServerOptions options = options_at(address);
        options.token_file = folder_.file("tokens");
        return options;
    }
    std::string socket() const { return "unix:" + folder_.file("socket"); }
    static ClientOptions with(const std::string& token) {
        ClientOptions options{.token = token};
        return options;
    }
    std::string refusal_of(service::ServerOptions options, ErrorCode code) const {
        return error_of(code, [&] { const service::Server server(options, silent()); });
    }

    TemporaryDirectory folder_;
};

TEST_F(Access, TokensLetIn) {
    const service::Server server(with_tokens(socket()), silent());
    EXPECT_EQ(ask(socket(), with(right)), right_answer);
    EXPECT_EQ(ask(socket(), with("fedcba9876543210")), right_answer);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), with(wrong_token)); }),
              socket() + ": the server does not accept this token");
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), with("")); }), socket() + ": the server requires a token");
}

TEST_F(Access, EveryCallWantsATokenButHealth) {
    const service::Server server(with_tokens(socket()), silent());
    const auto* calls = octopair::v1::Upload::descriptor()->file()->FindServiceByName("Octopair");
    ASSERT_NE(calls, nullptr);
    for (int i = 0; i < calls->method_count(); ++i) {
        const std::string path = "/octopair.v1.Octopair/" + calls->method(i)->name();
        for (const std::string& token : {std::string(), "Bearer " + std::string(wrong_token), std::string(right)}) {
            const grpc::StatusCode code = call_raw(socket(), path, token).error_code();
            EXPECT_EQ(code, grpc::StatusCode::UNAUTHENTICATED) << path << " with '" << token << "'";
        }
    }
    EXPECT_GE(calls->method_count(), 11);
    EXPECT_TRUE(call_raw(socket(), "/octopair.v1.Octopair/Describe", "Bearer " + std::string(right)).ok());
    EXPECT_TRUE(call_raw(socket(), "/grpc.health.v1.Health/Check").ok());
}

TEST_F(Access, OnlyAServerWithoutTokensTellsItsCalls) {
    const std::string reflection = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
    {
        const service::Server server(with_tokens(socket()), silent());
        EXPECT_EQ(call_raw(socket(), reflection).error_code(), grpc::StatusCode::UNIMPLEMENTED);
    }
    const service::Server server(options_at(socket()), silent());
    EXPECT_NE(call_raw(socket(), reflection).error_code(), grpc::StatusCode::UNIMPLEMENTED);
}

TEST_F(Access, TokenFilesOthersMayReadAreRefused) {
    const std::string file = folder_.file("tokens");
    for (const mode_t mode : {0640, 0604, 0620, 0602, 0644}) {
        ASSERT_EQ(::chmod(file.c_str(), mode), 0);
        EXPECT_EQ(refusal_of(with_tokens(socket()), ErrorCode::usage),
                  file + ": other users can access this secret file; restrict it to its owner (chmod 600)");
    }
    ASSERT_EQ(::chmod(file.c_str(), 0400), 0);
    const service::Server server(with_tokens(socket()), silent());
}

TEST_F(Access, TokenFilesThatHoldNoneAreRefused) {
    const std::string file = folder_.file("tokens");
    const auto refused = [&](const std::string& content) {
        write_secret(file, content);
        return refusal_of(with_tokens(socket()), ErrorCode::bad_input);
    };
    EXPECT_EQ(refused(""), file + ": the file contains no token");
    EXPECT_EQ(refused("# none\n"), file + ": the file contains no token");
    EXPECT_EQ(refused("anna\n"), file + ": line 1: a line must be NAME TOKEN, or NAME TOKEN until=TIME");
    EXPECT_EQ(refused("\nanna short\n"), file + ": line 2: a token must have at least 16 bytes");
    EXPECT_EQ(refused("a 0123456789abcdef\nb 0123456789abcdef\n"),
              file + ": line 2: an earlier line has the same name or token");
    ASSERT_EQ(::unlink(file.c_str()), 0);
    EXPECT_TRUE(has_text(refusal_of(with_tokens(socket()), ErrorCode::io_failed), file));
}

TEST_F(Access, TokenFilesOfClientsHaveOneToken) {
    const std::string file = folder_.file("token");
    for (const std::string content : {"0123456789abcdef", "0123456789abcdef\n", " 0123456789abcdef\t\r\n"}) {
        write_secret(file, content);
        EXPECT_EQ(service::read_token(file), "0123456789abcdef");
    }
    for (const std::string& content : {std::string(), std::string("\n"), std::string("01234567 89abcdef"),
                                       std::string("0123456789abcdef\v"), std::string("01234567\n89abcdef"),
                                       std::string("\xEF\xBB\xBF"
                                                   "0123456789abcdef"),
                                       std::string("0123456789abcde\0f", 17)}) {
        write_secret(file, content);
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)service::read_token(file); }),
                  file + ": must hold exactly one token, of printable ASCII characters");
    }
}

/// The path is not a URI: a token for one socket must not go to another.
TEST_F(Access, PathsOfSocketsMayHaveAnyCharacters) {
    for (const std::string name : {"so%63ket", "a b", "socket?x", "socket#x", "100%", "t\u00fcr", "a:b@c"}) {
        const std::string address = "unix:/" + folder_.file(name);  // begins with two slashes
        const service::Server server(with_tokens(address), silent());
        EXPECT_EQ(ask(address, with(right)), right_answer) << name;
    }
}

/// gRPC reads a name before the first colon as a scheme if it knows one of this name.
TEST(ServerAddress, HostsMayHaveTheNamesOfSchemes) {
    for (const std::string name : {"dns", "ipv4", "ipv6", "vsock", "xds", "google-c2p", "unix-abstract", "localhost"})
        EXPECT_EQ(service::parse_address(name + ":50051").uri(), "dns:///" + name + ":50051");
    EXPECT_EQ(service::parse_address("[fe80::1%eth0]:80").uri(), "dns:///%5Bfe80::1%25eth0%5D:80");
    EXPECT_EQ(service::parse_address("unix:///a b").uri(), "unix:/a%20b");
    EXPECT_EQ(service::parse_address("unix:50051").uri(), "unix:50051");
}

/// The interface of grpc::ServerCredentials after gRPC 1.51.
class LaterServerCredentials {
public:
    virtual ~LaterServerCredentials() { grpc_server_credentials_release(credentials_); }
    LaterServerCredentials(const LaterServerCredentials&) = delete;
    LaterServerCredentials& operator=(const LaterServerCredentials&) = delete;
    virtual void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>&) {}
    bool owns_credentials() const { return c_creds() != nullptr; }

protected:
    explicit LaterServerCredentials(grpc_server_credentials* credentials) : credentials_(credentials) {}
    grpc_server_credentials* c_creds() const { return credentials_; }

private:
    virtual int AddPortToServer(const std::string&, grpc_server*) { return 0; }

    grpc_server_credentials* credentials_;
};

TEST(InsecureCredentials, HaveTheFormOfLaterVersionsOfGrpc) {
    service::keep_grpc();
    EXPECT_TRUE(service::InsecureCredentials<LaterServerCredentials>({}).owns_credentials());
}

TEST_F(Access, AddressesThatOthersReachNeedProtection) {
    for (const std::string address : {"0.0.0.0:0", "[::]:0", "192.0.2.1:0", "[::ffff:127.0.0.1]:0"}) {
        EXPECT_EQ(refusal_of(options_at(address), ErrorCode::usage),
                  address +
                      ": other machines can reach it; that needs TLS (a certificate and its key), and tokens or an "
                      "authority for client certificates");
        EXPECT_EQ(refusal_of(with_tokens(address), ErrorCode::usage),
                  address + ": other machines can reach it; that needs TLS (a certificate and its key)");
    }
    for (const std::string address : {"127.0.0.1:0", "127.7.0.9:0", "localhost:0"}) {
        const service::Server server(options_at(address), silent());
        EXPECT_EQ(ask(server.address().text(), {}), right_answer) << address;
    }
}

TEST_F(Access, AServerRemovesOnlyItsOwnSocket) {
    const std::string path = folder_.file("socket");
    {
        const service::Server server(options_at(socket()), silent());
        ASSERT_EQ(::rename(path.c_str(), folder_.file("moved").c_str()), 0);
        write_file(path, "another one's");
    }
    EXPECT_EQ(read_file(path), "another one's");
    ASSERT_EQ(::unlink(path.c_str()), 0);
    { const service::Server server(options_at(socket()), silent()); }
    EXPECT_FALSE(std::filesystem::exists(path));
}

TEST_F(Access, TheSchemeOfATokenHasAnyCase) {
    const service::Server server(with_tokens(socket()), silent());
    for (const std::string scheme : {"bearer ", "BEARER ", "bEaReR "})
        EXPECT_TRUE(call_raw(socket(), "/octopair.v1.Octopair/Describe", scheme + right).ok()) << scheme;
    for (const std::string scheme : {"Basic ", "Bearer", "Bearer  ", ""})
        EXPECT_FALSE(call_raw(socket(), "/octopair.v1.Octopair/Describe", scheme + right).ok()) << scheme;
}

/// A client shows its token only where no other user can listen.
TEST_F(Access, TokensGoOnlyToSocketsOfTrustedUsers) {
    const service::Server server(with_tokens(socket()), silent());
    EXPECT_EQ(ask(socket(), with(right)), right_answer);
    ASSERT_EQ(::chmod(folder_.path().c_str(), 01777), 0);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), with(right)); }),
              socket() + ": the token is not sent, because other users can write to " + folder_.path() +
                  "; use a folder of your own");
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), with("")); }), socket() + ": the server requires a token");
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0700), 0);
    EXPECT_EQ(ask(socket(), with(right)), right_answer);
    if (::geteuid() != 0) GTEST_SKIP() << "only root can give a socket to another user";
    const auto of_user = [&](const std::string& user) {
        ClientOptions options = with(right);
        options.server_user = user;
        return options;
    };
    ASSERT_EQ(::lchown(folder_.file("socket").c_str(), 65534, gid_t(-1)), 0);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), with(right)); }),
              socket() + ": the token is not sent, because another user listens there");
    EXPECT_EQ(ask(socket(), of_user("nobody")), right_answer);
    EXPECT_EQ(ask(socket(), of_user("65534")), right_answer);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(socket(), of_user("no such user")); }),
              "no user has the name 'no such user'");
}

TEST_F(Access, TokensGoToLoopbackOnlyOnRequest) {
    const service::Server server(with_tokens("127.0.0.1:0"), silent());
    const std::string address = server.address().text();
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(address, with(right)); }),
              address +
                  ": a token is not sent without encryption, because any user of this machine may listen there; "
                  "use TLS, a Unix socket, or --token-in-clear");
    ClientOptions options = with(right);
    options.token_in_clear = true;
    EXPECT_EQ(ask(address, options), right_answer);
}

TEST_F(Access, TokensDoNotLeaveTheMachineInTheClear) {
    for (const std::string address : {"192.0.2.1:7000", "127.0.0.1.example.invalid:7000"}) {
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { ask(address, with(right)); }),
                  address + ": a token is sent to another machine only with encryption; use TLS");
    }
}

}  // namespace
}  // namespace octopair::test
