// Error: the one exception type that octopair throws.
//
// - Every failure of a public call throws an `Error`.
// - Its code is the kind of failure. Its message, one line, says what is wrong and where (file, object, value).
// - Public calls turn std::bad_alloc into Error{resource_limit}, unless their header says otherwise.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace [[gnu::visibility("default")]] octopair {

enum class ErrorCode : std::uint8_t {
    usage,           ///< options contradict each other, or the call is not supported here
    bad_input,       ///< a box, file or option value is invalid
    io_failed,       ///< the operating system failed to read or write
    resource_limit,  ///< memory or another bounded resource ran out
    engine_failed,   ///< an engine failed, or its result is wrong
    cancelled,       ///< the caller requested a stop
};

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

}  // namespace octopair
