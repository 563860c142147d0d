// Runs a program, and reports an error as one line on standard error and an exit status.
#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <functional>

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

/// Prints the message, at most 4,000 bytes. Returns the exit status. Allocates no memory. Control characters become '?', because a
/// terminal would obey them. Names of files may have some.
inline int fail(ErrorCode code, const char* message) {
    constexpr std::size_t max_bytes = 4000;
    char line[max_bytes + 1];
    std::size_t length = 0;
    for (; message[length] != '\0' && length < max_bytes; ++length) {
        const char c = message[length];
        line[length] = (c >= 0 && c < ' ' && c != '\n') || c == 0x7F ? '?' : c;
    }
    line[length] = '\0';
    std::fprintf(stderr, "%s: %s\n", program_name, line);
    return status_of(code);
}

inline int fail(const Error& error) {
    const char* const stopped = stop_signal == SIGTERM ? "terminated" : "interrupted";
    return fail(error.code(), error.code() == ErrorCode::cancelled ? stopped : error.what());
}

/// The work of a subcommand. Returns the exit status. May throw.
using Action = std::function<int()>;

/// Calls `run`, and returns its exit status. An exception becomes one line on standard error, which begins with `program`, and
/// the exit status of its error code. SIGPIPE and SIGXFSZ are ignored, so that write() fails instead of ending the program.
/// Requires: called once, from main(); `program` lives until the program ends.
int program_main(const char* program, const Action& run);

}  // namespace octopair::cli
