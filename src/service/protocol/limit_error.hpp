// LimitError: an error that names the limit of the server that refused a call.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "octopair/error.hpp"

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

}  // namespace octopair::service
