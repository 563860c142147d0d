// LimitError: an Error{resource_limit} that names the limit of the server that a call exceeds.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "octopair/error.hpp"

namespace octopair::service {

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

}  // namespace octopair::service
