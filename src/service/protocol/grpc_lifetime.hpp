// Lifetime of the gRPC library.
#pragma once

#include <grpc/grpc.h>

namespace octopair::service {

/// Keeps the gRPC library initialised until the process ends. Otherwise gRPC shuts down with the last channel or server, which
/// may take ten seconds, and delays the destruction of an engine or server.
inline void keep_grpc() {
    static const bool kept = (grpc_init(), true);
    (void)kept;
}

}  // namespace octopair::service
