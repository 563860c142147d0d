// Conversion between Error and gRPC status. The details of a status carry the library's own error as a Failure message.
#pragma once

#include <grpcpp/support/status.h>

#include <string>

#include "octopair/error.hpp"

namespace octopair::v1 {
class Failure;
}  // namespace octopair::v1

namespace octopair::service {

v1::Failure failure_of(const Error& error);
/// Throws: LimitError if `failure` names a limit, otherwise Error.
[[noreturn]] void throw_failure(const v1::Failure& failure);

grpc::Status status_of(const Error& error);
grpc::Status status_of(const v1::Failure& failure);

/// Throws the Error that a status describes. gRPC itself makes statuses without details: the server is unreachable, the caller has no
/// permission, or the server is not octopair. `server`: name of the server in the message. Requires: the status is not OK.
[[noreturn]] void throw_status(const grpc::Status& status, const std::string& server);

/// Returns whether a retry of the call may succeed, because the server was unavailable or shuts down.
/// Requires: the caller has not cancelled the call.
bool is_retryable(const grpc::Status& status);

/// Returns the status for the current exception, of any type. Requires: called from an exception handler.
grpc::Status status_of_exception();

}  // namespace octopair::service
