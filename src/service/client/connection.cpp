#include "service/client/connection.hpp"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <thread>
#include <vector>

#include "base/stop.hpp"
#include "octopair/error.hpp"
#include "service/protocol/address.hpp"
#include "service/protocol/credential_files.hpp"
#include "service/protocol/grpc_lifetime.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.grpc.pb.h"
#include "service/protocol/status.hpp"

namespace octopair::service {

namespace {

/// Describe gets at least this deadline, even if the user's time-out is shorter. A shorter deadline could end before any answer arrives.
constexpr std::chrono::milliseconds min_deadline(1000);

bool encrypts(const ClientOptions& options) {
    return options.tls || !options.authority.empty() || !options.certificate.empty();
}

/// Throws: Error{usage} if the token may not be sent over TCP without encryption.
void check_clear_token(const Address& address, const ClientOptions& options) {
    if (!is_this_machine(address)) {
        throw Error(ErrorCode::usage,
                    address.text() + ": a token is sent to another machine only with encryption; use TLS");
    }
    if (options.token_in_clear) return;
    throw Error(ErrorCode::usage, address.text() +
                                      ": a token is not sent without encryption, because any user of this machine may "
                                      "listen there; use TLS, a Unix socket, or --token-in-clear");
}

namespace fs = std::filesystem;

[[noreturn]] void refuse_socket(const std::string& path, const std::string& why) {
    throw Error(ErrorCode::usage, "unix:" + path + ": the token is not sent, because " + why);
}

uid_t user_of(const std::string& name) {
    uid_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size()) return number;
    const passwd* const known = ::getpwnam(name.c_str());  // not thread-safe; a program calls it on one thread only
    if (known == nullptr) throw Error(ErrorCode::usage, "no user has the name '" + name + "'");
    return known->pw_uid;
}

std::vector<uid_t> trusted_users(const std::string& server_user) {
    std::vector<uid_t> users = {::geteuid(), 0};
    if (!server_user.empty()) users.push_back(user_of(server_user));
    return users;
}

/// Checks that no untrusted user can replace the socket at `path`. The socket need not exist.
/// Trusted users are this user, root, and `server_user` (a name or number; empty: nobody else). Trusted users must own the socket and
/// all folders above the socket. Other users must not have write access to these folders, except sticky folders above, like /tmp.
/// Throws: Error{usage} that names the folder or socket, or an unknown user.
void check_socket_trust(const std::string& path, const std::string& server_user) {
    const std::vector<uid_t> users = trusted_users(server_user);
    const auto is_trusted = [&](const struct stat& found) {
        return std::find(users.begin(), users.end(), found.st_uid) != users.end();
    };
    std::error_code error;
    const fs::path socket = fs::weakly_canonical(fs::absolute(path, error), error);
    struct stat found {};
    if (::lstat(socket.c_str(), &found) == 0 && !is_trusted(found)) refuse_socket(path, "another user listens there");
    for (fs::path folder = socket.parent_path();; folder = folder.parent_path()) {
        if (::stat(folder.c_str(), &found) != 0)
            refuse_socket(path, "the folder " + folder.string() + " cannot be examined");
        if (!is_trusted(found)) refuse_socket(path, "the folder " + folder.string() + " belongs to another user");
        const bool open = (found.st_mode & (S_IWGRP | S_IWOTH)) != 0;
        const bool keeps_entries = (found.st_mode & S_ISVTX) != 0 && folder != socket.parent_path();
        if (open && !keeps_entries)
            refuse_socket(path, "other users can write to " + folder.string() + "; use a folder of your own");
        if (folder == folder.root_path()) return;
    }
}

std::shared_ptr<grpc::ChannelCredentials> credentials_of(const Address& address, const ClientOptions& options) {
    if (options.certificate.empty() != options.key.empty()) {
        throw Error(ErrorCode::usage, "a certificate needs its key, and a key its certificate");
    }
    if (!encrypts(options)) {
        if (!options.token.empty() && !address.is_unix()) check_clear_token(address, options);
        return grpc::InsecureChannelCredentials();
    }
    grpc::SslCredentialsOptions files;
    if (!options.authority.empty()) {
        files.pem_root_certs = read_small_file(options.authority);
        check_certificate({files.pem_root_certs, options.authority});
    }
    if (!options.certificate.empty()) {
        files.pem_cert_chain = read_small_file(options.certificate);
        files.pem_private_key = read_private_file(options.key);
        check_key({files.pem_cert_chain, options.certificate}, {files.pem_private_key, options.key});
    }
    return grpc::SslCredentials(files);
}

grpc::ChannelArguments arguments() {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(int(max_message_bytes));
    arguments.SetMaxSendMessageSize(int(max_message_bytes));
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // each engine has its own connection
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
    // Pings detect during a call that the server or the network has failed without closing the connection.
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 20'000);
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
    arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);  // no limit
    arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);  // call_with_retries() retries, because the input must be sent again
    return arguments;
}

/// Returns whether the server refused the connection because of its limit on connections. gRPC then reports only the frame GOAWAY.
bool refuses_connections(const grpc::Status& status) {
    return status.error_message().find("GOAWAY") != std::string::npos;
}

/// Returns whether the call was lost after a connection had been made.
bool was_connected(const grpc::Status& status) {
    const std::string words = status.error_message();
    return !refuses_connections(status) && words.find("failed to connect") == std::string::npos &&
           words.find("empty address list") == std::string::npos &&
           words.find("DNS resolution failed") == std::string::npos;
}

/// Checks the token, because gRPC ends the program if metadata has other characters.
void check_token(std::string_view token) {
    const auto may_be_sent = [](char c) { return c >= ' ' && c <= '~'; };
    if (std::all_of(token.begin(), token.end(), may_be_sent)) return;
    throw Error(ErrorCode::usage, "the token has invalid characters: it may only have printable ASCII characters");
}

}  // namespace

Connection::Connection(std::string_view address, const ClientOptions& options)
    : server_(address),
      token_(options.token),
      connect_timeout_(options.connect_timeout),
      reconnect_timeout_(options.patience),
      channel_(grpc::CreateCustomChannel(parse_address(address).uri(), credentials_of(parse_address(address), options),
                                         arguments())) {
    check_token(token_);
    const Address parsed = parse_address(address);
    if (parsed.is_unix() && !token_.empty()) guarded_socket_ = parsed.path;
    server_user_ = options.server_user;
    check_socket();
    keep_grpc();
}

void Connection::check_socket() const {
    if (!guarded_socket_.empty()) check_socket_trust(guarded_socket_, server_user_);
}

void Connection::prepare(grpc::ClientContext& context) const {
    if (!token_.empty()) context.AddMetadata("authorization", "Bearer " + token_);
}

void Connection::check_server() {
    const auto calls = v1::Octopair::NewStub(channel_);
    v1::ServerDescription description;
    call_with_retries({}, [&] {
        grpc::ClientContext context;
        prepare(context);
        context.set_deadline(std::chrono::system_clock::now() +
                             std::max<std::chrono::milliseconds>(connect_timeout_, min_deadline));
        return calls->Describe(&context, {}, &description);
    });
}

void Connection::throw_unavailable(const grpc::Status& status, bool refused) const {
    if (refused) {
        throw Error(ErrorCode::resource_limit,
                    server_ + ": the server accepts no more connections: its limit is reached");
    }
    throw Error(ErrorCode::engine_failed, server_ + ": no server answers: " + status.error_message());
}

void Connection::RetryTimer::wait_or_throw(const grpc::Status& status, const std::stop_token& stop) {
    throw_if_stopped(stop);
    if (!is_retryable(status)) throw_status(status, connection_.server_);
    constexpr std::chrono::milliseconds apart(50);
    const auto now = Clock::now();
    if (unavailable_since_ == Clock::time_point() || connection_.heard_.load() > unavailable_since_) {
        unavailable_since_ = now;
        refused_ = false;
    }
    if (refuses_connections(status)) refused_ = true;
    // A connection that the server refuses may break before GOAWAY arrives. Such a break does not show that the server takes calls.
    if (was_connected(status) && !refused_) connection_.met();
    connection_.check_socket();
    // Sleep before the next attempt: gRPC itself would reconnect thousands of times a second.
    std::this_thread::sleep_for(refuses_connections(status) ? 4 * apart : apart);
    // gRPC connects only while a thread waits in gRPC. WaitForConnected() returns after `apart`; a call would wait until its deadline.
    do {
        throw_if_stopped(stop);
        if (Clock::now() - unavailable_since_ >=
            (connection_.met_ ? connection_.reconnect_timeout_ : connection_.connect_timeout_))
            connection_.throw_unavailable(status, refused_);
    } while (!connection_.channel_->WaitForConnected(std::chrono::system_clock::now() + apart));
}

}  // namespace octopair::service
