// RemoteJob: one call of the remote engine, as a job of the server's.
//
// Small input goes in one message, and so does a small result. All else goes in a stream; where that breaks, the whole job
// is sent again, under its own id, and the pairs that were there already are left out by the server.
#pragma once

#include "engine/request.hpp"
#include "service/client/connection.hpp"
#include "service/client/received.hpp"
#include "service/client/uploader.hpp"

namespace octopair::service {

class RemoteJob {
public:
    /// All are borrowed.
    RemoteJob(Connection& connection, const Engine::Request& request, const Engine::Output& output,
              const Engine::Control& control);

    /// Throws Error, and what a sink or a progress throws.
    Summary run();

private:
    bool run_small();
    void raise_small_input();
    grpc::Status call_small();
    grpc::Status call_stream();
    void begin_attempt();

    Connection& connection_;
    const std::stop_token stop_;
    const bool pairs_wanted_;
    Uploader upload_;
    Received received_;
};

}  // namespace octopair::service
