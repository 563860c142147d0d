// Errors as statuses of gRPC, and back: the status that others understand, and in its details the library's own code.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "octopair/error.hpp"

namespace octopair::v1 {
class Failure;
}  // namespace octopair::v1

namespace octopair::service {

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
