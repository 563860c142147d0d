// Reports an error as one line on standard error and an exit status.
#pragma once

#include <cstdio>

#include "base/error_codes.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

/// Name of the program, which messages begin with. program_main() sets it.
inline constinit const char* program_name = "octopair";

/// Prints the message. Returns the exit status. Allocates no memory.
inline int fail(ErrorCode code, const char* message) {
    std::fprintf(stderr, "%s: %s\n", program_name, message);
    return exit_status(code);
}

inline int fail(const Error& error) {
    return fail(error.code(), error.code() == ErrorCode::cancelled ? "interrupted" : error.what());
}

}  // namespace octopair::cli
