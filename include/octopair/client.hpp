// The remote engine: a server (`octopair serve`) finds the pairs. The application only sends boxes and receives pairs.
//
// Result    The same bytes as from every engine.
// Jobs      submit() returns at once. A thread of the engine sends the boxes to the server.
// Faults    If the server becomes unreachable during a call, the engine repeats its requests until the server answers or
//           ClientOptions::patience has passed. A sink receives each pair once nevertheless.
// Errors    If the server stays unreachable or refuses the call: Error{resource_limit}, which names the server's limit;
//           Error{engine_failed}; or the Error that the server's engine throws.
// Memory    The pairs, and a few MiB.
// Protocol  gRPC (docs/protocol.md). CMake: link octopair::client.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "octopair/engine.hpp"

namespace [[gnu::visibility("default")]] octopair {

struct ClientOptions {
    std::chrono::milliseconds connect_timeout = std::chrono::seconds(5);  ///< longest wait for the first connection
    std::chrono::milliseconds patience = std::chrono::seconds(30);        ///< longest outage that a call survives
    /// One of the server's tokens; empty: none. Sent only over encrypted connections, and over Unix sockets where no other user can
    /// listen: in a folder that only this user, root and `server_user` can write to.
    std::string token = {};
    /// Name or number of the user that runs the server at a Unix socket; empty if this user or root runs the server.
    std::string server_user = {};
    /// True: the token is also sent to this machine's loopback addresses without encryption. Any user of this machine may listen there
    /// while the server does not.
    bool token_in_clear = false;
    /// For a JobClient with the role operator: owner of the jobs that calls name by id. Empty: the id must belong to one owner's job only.
    std::string owner = {};
    /// PEM file of a certificate authority. If set, the connection is encrypted and the server's certificate must be of this
    /// authority. If empty, the connection is encrypted only if `certificate` or `tls` is set.
    std::string authority = {};
    /// PEM files of this client's certificate and private key; empty: none.
    std::string certificate = {}, key = {};
    /// True: the connection is encrypted. If `authority` is empty, the system's trusted authorities decide whether to trust the server.
    bool tls = false;
};

/// Connects to the server at `address`, unix:PATH or HOST:PORT, and returns an engine that uses it.
/// Throws: Error{usage} for a malformed address or options that contradict each other; Error{io_failed} for a file that cannot
/// be read; Error{bad_input} for a file without a certificate, or a key of another certificate; Error{engine_failed} if the
/// server cannot be reached.
std::unique_ptr<Engine> connect(std::string_view address, const ClientOptions& options = {});

}  // namespace octopair
