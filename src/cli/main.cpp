// The program: parses, runs the chosen subcommand, and turns what it throws into a line and an exit status.
#include <csignal>
#include <new>
#include <system_error>

#include "cli/command/command.hpp"
#include "cli/command/failure.hpp"
#include "cli/subcommands.hpp"
#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

int run(int argc, char** argv) {
    CommandLine line("octopair", "Every colliding pair among millions of moving 3D objects.",
                     "octopair " OCTOPAIR_VERSION);
    Command program = line.program();
    program.require_subcommand();
    Action action;
    add_detect(program, action);
    add_generate(program, action);
    add_info(program, action);
    add_replay(program, action);
#ifdef OCTOPAIR_WITH_SERVICE
    add_serve(program, action);
    add_submit(program, action);
    add_status(program, action);
    add_result(program, action);
    add_cancel(program, action);
#endif
    add_bench(program, action);
    if (const auto status = line.parse(argc, argv)) return *status;
    return action();
}

/// Runs with every exception caught; want of memory must not need memory to be reported.
int guarded_run(int argc, char** argv) {
    try {
        return run(argc, argv);
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

}  // namespace

}  // namespace octopair::cli

int main(int argc, char** argv) {
    // A closed pipe and a file-size limit are errors of write(), with a message, and not the end.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    return octopair::cli::guarded_run(argc, argv);
}
