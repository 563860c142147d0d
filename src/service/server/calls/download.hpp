// Download: the messages that bring a job's pairs to a client, from an offset on.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include <cstdint>
#include <memory>

#include "service/server/jobs/server_job.hpp"

namespace octopair::service {

class Download {
public:
    explicit Download(std::shared_ptr<ServerJob> job, std::uint64_t offset = 0)
        : job_(std::move(job)), offset_(offset) {}

    struct Next {
        enum class Kind : std::uint8_t { wait, message, last } kind = Kind::wait;
        grpc::ByteBuffer message;  ///< of `message`, and of `last` if its status is OK
        grpc::Status status;       ///< of `last`
    };
    /// What can be sent now: nothing yet, a message, or the last with the status that ends the call.
    Next next();

private:
    Next make_next();

    std::shared_ptr<ServerJob> job_;
    std::uint64_t offset_;
    bool head_sent_ = false;
    double progress_sent_ = 0;
};

}  // namespace octopair::service
