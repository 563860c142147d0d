// Errors as statuses of gRPC, and back: the status that others understand, and in its details the library's own code.
#pragma once

#include <grpcpp/support/status.h>

#include <cstdint>
#include <string>

#include "octopair/error.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

/// An Error{resource_limit} that names the server's limit.
class LimitError : public Error {
public:
    /// `name`: as in the message Limits. `message` says the limit as well.
    LimitError(std::string name, std::uint64_t allowed, const std::string& message)
        : Error(ErrorCode::resource_limit, message), name_(std::move(name)), allowed_(allowed) {}

    const std::string& name() const { return name_; }
    std::uint64_t allowed() const { return allowed_; }

private:
    std::string name_;
    std::uint64_t allowed_;
};

v1::Failure failure_of(const Error& error);
/// A LimitError if it names a limit.
[[noreturn]] void throw_failure(const v1::Failure& failure);

grpc::Status status_of(const Error& error);
grpc::Status status_of(const v1::Failure& failure);

/// Throws what a status that is not OK says. One without details is of gRPC itself: the server is not there, the caller
/// may not, or the other side is no octopair; `server` names it in the message.
[[noreturn]] void throw_status(const grpc::Status& status, const std::string& server);

/// The same call may succeed later: the server is gone or going. Of a call that its caller did not cancel.
bool may_come_back(const grpc::Status& status);

/// The exception under way as a status; it may be any.
grpc::Status status_of_exception();

}  // namespace octopair::service
