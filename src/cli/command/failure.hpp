// Reports an error as one line on standard error and an exit status.
#pragma once

#include <atomic>
#include <csignal>
#include <cstdio>

#include "base/error_codes.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

/// Name of the program, which messages begin with. program_main() sets it.
inline constinit const char* program_name = "octopair";

/// Signal of the last stop request. Interrupt sets it.
inline constinit std::atomic<int> stop_signal = SIGINT;

/// Returns the exit status of an error. A run that a signal stopped has 128 plus the signal's number, as in a shell.
inline int status_of(ErrorCode code) {
    return code == ErrorCode::cancelled ? 128 + stop_signal.load() : exit_status(code);
}

/// Prints the message. Returns the exit status. Allocates no memory.
inline int fail(ErrorCode code, const char* message) {
    std::fprintf(stderr, "%s: %s\n", program_name, message);
    return status_of(code);
}

inline int fail(const Error& error) {
    const char* const stopped = stop_signal == SIGTERM ? "terminated" : "interrupted";
    return fail(error.code(), error.code() == ErrorCode::cancelled ? stopped : error.what());
}

}  // namespace octopair::cli
