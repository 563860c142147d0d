// Subclasses of Error that a server throws. A client distinguishes them from other errors with the same ErrorCode.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "octopair/error.hpp"

namespace octopair::service {

/// An Error{resource_limit} that names the limit of the server that a call exceeds.
class LimitError : public Error {
public:
    /// `name` is the name of the field in the protocol's message Limits. `message` is complete, and contains the limit.
    LimitError(std::string name, std::uint64_t allowed, const std::string& message)
        : Error(ErrorCode::resource_limit, message), name_(std::move(name)), allowed_(allowed) {}

    const std::string& name() const { return name_; }
    std::uint64_t allowed() const { return allowed_; }

private:
    std::string name_;
    std::uint64_t allowed_;
};

/// An Error{bad_input} because the caller has no such job.
class NoJobError : public Error {
public:
    explicit NoJobError(const std::string& message) : Error(ErrorCode::bad_input, message) {}
};

}  // namespace octopair::service
