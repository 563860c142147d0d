// gRPC itself, which the first to use it starts.
#pragma once

namespace octopair::service {

/// From now on gRPC stays: its end, when the last channel or server goes, may take it ten seconds, and a server or an
/// engine should go at once.
void keep_grpc();

}  // namespace octopair::service
