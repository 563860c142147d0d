// Errors: the one exception type that octopair throws.
//
// Every failure of a public call is an `Error` whose code says what kind it is and whose message says, in one line,
// what was wrong and where (file, object, value). std::bad_alloc becomes Error{resource_limit} at the edge of the
// library.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace octopair {

enum class ErrorCode : std::uint8_t {
    usage,           ///< the caller's options make no sense together
    bad_input,       ///< a box, file or option value is not what it must be
    io_failed,       ///< the operating system failed to read or write
    resource_limit,  ///< memory or another bounded resource ran out
    engine_failed,   ///< an engine could not do its work
    cancelled,       ///< the caller asked to stop
};

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

}  // namespace octopair
