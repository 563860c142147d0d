// A server in the test's process, at its own port or socket, with the token and certificate files that protect it.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/null_sink.h>
#include <sys/stat.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "io/temporary.hpp"
#include "octopair/client.hpp"
#include "octopair/octopair.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/server.hpp"

namespace octopair::test {

inline std::shared_ptr<spdlog::logger> silent() {
    return service::make_log(service::LogForm::text, std::make_shared<spdlog::sinks::null_sink_mt>());
}

inline service::ServerOptions options_at(const std::string& address) {
    service::ServerOptions options;
    options.listen = service::parse_address(address);
    options.engine = [](unsigned width) { return make_local_engine(width); };
    options.engine_name = "local";
    return options;
}

/// Detects the pairs of three boxes, two of which overlap.
inline std::vector<Pair> ask(const std::string& address, ClientOptions options) {
    options.patience = std::chrono::milliseconds(300);
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{5, 5, 5}, {6, 6, 6}}, {{1, 0, 0}, {2, 1, 1}}};
    PairList pairs;
    connect(address, options)->find_pairs({boxes}, pairs);
    return pairs.to_vector();
}
inline const std::vector<Pair> right_answer = {{0, 2}};

/// Writes a file that only the test's user can read.
inline void write_secret(const std::string& path, const std::string& content) {
    write_file(path, content);
    ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
}

/// Makes a certificate authority and signed certificates with the openssl command line: NAME.pem and NAME.key. Names:
/// "server", "client", "expired-server", "expired-client", and "stranger", which another authority signed.
class Certificates {
public:
    Certificates() {
        make_authority("authority");
        make_authority("other");
        sign("server", "authority", 2);
        sign("client", "authority", 2);
        sign("expired-server", "authority", -1);
        sign("expired-client", "authority", -1);
        sign("stranger", "other", 2);
        for (const auto& [name, subject, extension] : named) sign(name, subject, extension);
    }

    /// Client certificates with other names: file, subject, and extension.
    static constexpr std::array<std::array<const char*, 3>, 6> named = {
        {{"nameless", "/O=octopair", "basicConstraints=CA:FALSE"},
         {"nameless-too", "/O=octopair two", "basicConstraints=CA:FALSE"},
         {"by-common-name", "/CN=anna", "basicConstraints=CA:FALSE"},
         {"by-dns", "/CN=anna", "subjectAltName=DNS:anna.example"},
         {"by-email", "/O=octopair", "subjectAltName=DNS:anna.example,email:anna@example.org"},
         {"by-uri", "/CN=anna", "subjectAltName=email:anna@example.org,URI:spiffe://example.org/anna"}}};

    std::string pem(const std::string& name) const { return folder_.file(name + ".pem"); }
    std::string key(const std::string& name) const { return folder_.file(name + ".key"); }

private:
    void run(const std::string& line) const {
        const std::string script = "cd '" + folder_.path() + "' && { " + line + "; } >log 2>&1";
        if (std::system(script.c_str()) != 0) throw std::runtime_error(line + ": " + read_file(folder_.file("log")));
    }
    void make_authority(const std::string& name) const {
        run("openssl req -x509 " + fresh(name) + " -out " + name + ".pem -days 2 -subj /CN=" + name);
    }
    void sign(const std::string& name, const std::string& authority, int days) const {
        run("openssl req " + fresh(name) + " -out request -subj /CN=" + name);
        sign_request(name, authority, days, "subjectAltName=DNS:localhost,IP:127.0.0.1");
    }
    void sign(const std::string& name, const std::string& subject, const std::string& extension) const {
        run("openssl req " + fresh(name) + " -out request -subj '" + subject + "'");
        sign_request(name, "authority", 2, extension);
    }
    // NOLINTNEXTLINE(readability-function-size): they are the arguments of one command
    void sign_request(const std::string& name, const std::string& authority, int days,
                      const std::string& extension) const {
        run("echo '" + extension + "' > names && openssl x509 -req -in request -CA " + authority + ".pem -CAkey " +
            authority + ".key -CAcreateserial -extfile names -days " + std::to_string(days) + " -out " + name + ".pem");
    }
    static std::string fresh(const std::string& name) {
        return "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -keyout " + name + ".key";
    }

    TemporaryDirectory folder_;
};

/// Sends a single message to the method at a path, without octopair's client.
inline grpc::Status call_raw(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                             const std::string& token, grpc::ByteBuffer& answer) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
    if (!token.empty()) context.AddMetadata("authorization", token);
    grpc::GenericStub stub(channel);
    grpc::CompletionQueue queue;
    const grpc::Slice nothing;
    const auto call = stub.PrepareUnaryCall(&context, method, grpc::ByteBuffer(&nothing, 1), &queue);
    call->StartCall();
    grpc::Status status;
    call->Finish(&answer, &status, nullptr);
    void* tag = nullptr;
    bool ok = false;
    (void)queue.Next(&tag, &ok);
    return status;
}

/// Makes the call over a connection of its own, and ignores the answer.
inline grpc::Status call_raw(const std::string& address, const std::string& method, const std::string& token = "") {
    grpc::ByteBuffer answer;
    return call_raw(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()), method, token, answer);
}

}  // namespace octopair::test
