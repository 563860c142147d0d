// Download: makes the messages that send a job's pairs to a client, starting at a given pair.
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
        grpc::ByteBuffer message;  ///< set for `message`, and for `last` if `status` is OK
        grpc::Status status;       ///< status of the call; set for `last`
    };
    /// Returns what to send next: nothing yet, a message, or the last message and the status that ends the call.
    Next next();

private:
    Next make_next();

    std::shared_ptr<ServerJob> job_;
    std::uint64_t offset_;
    bool head_sent_ = false;
    double progress_sent_ = 0;
};

}  // namespace octopair::service
