// Lifetime of the gRPC library.
#pragma once

namespace octopair::service {

/// Keeps the gRPC library initialised until the process ends. Otherwise gRPC shuts down with the last channel or server, which
/// may take ten seconds, and delays the destruction of an engine or server.
void keep_grpc();

}  // namespace octopair::service
