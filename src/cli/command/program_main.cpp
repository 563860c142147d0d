#include "cli/command/program_main.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

int program_main(const char* program, const Action& run) {
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    program_name = program;
    // Use fail(), which allocates no memory: the exception may be std::bad_alloc.
    try {
        const int status = run();
        // Short texts, such as the help, are still in the buffer of stdout. Flush it, so that an error of writing gives an exit status.
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail_io("standard output", "cannot write", errno);
        return status;
    } catch (const Error& error) {
        return fail(error);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::resource_limit, "out of memory");
    } catch (const std::system_error& error) {
        const bool want = error.code() == std::errc::resource_unavailable_try_again;
        return fail(want ? ErrorCode::resource_limit : ErrorCode::engine_failed,
                    want ? "cannot start another thread" : error.what());
    } catch (const std::exception& error) {
        return fail(ErrorCode::engine_failed, error.what());
    }
}

}  // namespace octopair::cli
