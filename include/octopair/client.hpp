// The remote engine: pairs are found by a server (`octopair serve`), the application only sends boxes and receives pairs.
//
// Result    the same bytes as from every engine.
// Jobs      submit() returns at once: the boxes go to the server on a thread of the engine's own.
// Faults    a server that goes away in the middle of a call is waited for and asked again, as long as
//           ClientOptions::patience; a sink receives each pair once nevertheless. Then, or where the server refuses, the call
//           throws: Error{resource_limit} that names the server's limit, Error{engine_failed}, or what the engine of the
//           server would throw.
// Memory    the pairs, and a few MiB.
// Protocol  gRPC (docs/protocol.md). CMake: link octopair::client.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>

#include "octopair/engine.hpp"

namespace octopair {

struct ClientOptions {
    std::chrono::milliseconds connect_timeout = std::chrono::seconds(5);  ///< for the first connection
    std::chrono::milliseconds patience = std::chrono::seconds(30);        ///< how long the server may be away later
    /// One of the server's tokens; empty: none. It is sent over connections that are encrypted or stay on this machine.
    std::string token = {};
    /// Encrypt, and trust servers with a certificate of this authority (a PEM file); empty: do not, unless `certificate`
    /// or `tls` says so.
    std::string authority = {};
    /// Of this client, PEM files; empty: none.
    std::string certificate = {}, key = {};
    /// Encrypt, with the authorities that the system trusts unless `authority` is given.
    bool tls = false;
};

/// `address`: unix:PATH or HOST:PORT. Throws Error{usage} for what is none, or options that do not fit together;
/// Error{io_failed} for a file that cannot be read, Error{bad_input} for one that holds no certificate or not its key,
/// Error{engine_failed} if the server cannot be reached.
std::unique_ptr<Engine> connect(std::string_view address, const ClientOptions& options = {});

}  // namespace octopair
