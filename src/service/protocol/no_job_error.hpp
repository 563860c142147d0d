// NoJobError: an Error{bad_input} because the caller has no such job.
#pragma once

#include <string>

#include "octopair/error.hpp"

namespace octopair::service {

class NoJobError : public Error {
public:
    explicit NoJobError(const std::string& message) : Error(ErrorCode::bad_input, message) {}
};

}  // namespace octopair::service
