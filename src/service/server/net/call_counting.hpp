// CallCounting: counts the calls of each connection, so that the listener can cut a connection that resets too many.
//
// gRPC reads a connection on a thread for as long as data comes. Only then the thread handles the calls that it has read. So a flood of
// calls that are reset would fill the memory before a handler runs. The begin of a call is therefore counted where gRPC authenticates it:
// on the thread that reads. The end is counted where gRPC frees the call (an interceptor).
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
    /// Makes credentials of TLS count calls.
    void count_in(grpc::ServerCredentials& credentials);
    /// Returns what counts the ends of calls.
    std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors();

    /// Returns the number of the connection of a call (ConnectionWatch::note_begin).
    static std::uint64_t connection_of(const grpc::ServerContextBase& call);

private:
    Listener& listener_;
};

}  // namespace octopair::service
