// The program: parses, runs the chosen subcommand, and turns what it throws into a line and an exit status.
#include <csignal>
#include <new>
#include <string>
#include <system_error>

#include "cli/failure.hpp"
#include "cli/subcommands.hpp"
#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

int run(int argc, char** argv) {
    CLI::App app("Every colliding pair among millions of moving 3D objects.", "octopair");
    app.set_version_flag("--version", "octopair " OCTOPAIR_VERSION);
    app.require_subcommand(1);
    Action action;
    add_detect(app, action);
    add_generate(app, action);
    add_info(app, action);
    add_replay(app, action);
#ifdef OCTOPAIR_WITH_SERVICE
    add_serve(app, action);
    add_submit(app, action);
    add_status(app, action);
    add_result(app, action);
    add_cancel(app, action);
#endif
    add_bench(app, action);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        return fail(ErrorCode::usage, (std::string(error.what()) + " (octopair --help tells more)").c_str());
    }
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
