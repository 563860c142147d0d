// CallCounting: counts the calls of each connection, so that the listener can cut a connection that resets too many.
//
// A thread of gRPC reads a connection as long as data arrive, and starts the handlers of the calls afterwards. So a client that starts
// and resets many calls would fill the memory before any handler runs. Therefore the authentication, which runs on the reading thread,
// counts the begin of each call. An interceptor counts the end, when gRPC frees the call.
#pragma once

#include <grpc/grpc_security.h>
#include <grpcpp/support/server_interceptor.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace grpc {
class ServerContextBase;
class ServerCredentials;
}  // namespace grpc

namespace octopair::service {

class Listener;

class CallCounting {
public:
    /// Borrows the listener, which outlives the server.
    explicit CallCounting(Listener& listener) : listener_(listener) {}

    /// Returns credentials that count the calls of a server which needs no TLS.
    std::shared_ptr<grpc::ServerCredentials> insecure_credentials();
    /// Adds a processor to TLS credentials that counts the begins of calls.
    void count_in(grpc::ServerCredentials& credentials);
    /// Returns factories of interceptors that count the ends of calls.
    std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors();

    /// Returns the number of the connection of a call (ConnectionWatch::note_begin).
    static std::uint64_t connection_of(const grpc::ServerContextBase& call);

private:
    Listener& listener_;
};

}  // namespace octopair::service
