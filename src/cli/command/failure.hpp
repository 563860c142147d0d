// How a failure is told: one line on standard error, and an exit status.
#pragma once

#include <cstdio>

#include "base/error_codes.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

/// The name that messages begin with. program_main() sets it.
inline constinit const char* program_name = "octopair";

/// Needs no memory. Returns the exit status.
inline int fail(ErrorCode code, const char* message) {
    std::fprintf(stderr, "%s: %s\n", program_name, message);
    return exit_status(code);
}

inline int fail(const Error& error) {
    return fail(error.code(), error.code() == ErrorCode::cancelled ? "interrupted" : error.what());
}

}  // namespace octopair::cli
