// The program octopair: parses the command line, and runs the chosen subcommand.
#include "cli/command/command.hpp"
#include "cli/command/program_main.hpp"
#include "cli/subcommands.hpp"
#include "octopair/error.hpp"
#include "octopair/version.hpp"

namespace octopair::cli {

namespace {

#ifndef OCTOPAIR_WITH_VIEWER
/// Adds the subcommand `view` to a build without the viewer. It only fails with a message that says how to get the viewer.
void add_missing_view(Command& program) {
    Command command = program.add_subcommand("view", "show a scene in a browser (not in this build)");
    command.ignore_other_arguments();
    command.callback([] {
        throw Error(
            ErrorCode::usage,
            "view: this octopair was built without the viewer; `scripts/run view INPUT` builds it, and so does CMake "
            "with -DOCTOPAIR_WITH_VIEWER=ON");
    });
}
#endif

int run(int argc, char** argv) {
    CommandLine line("octopair", "Every colliding pair among millions of moving 3D objects.",
                     "octopair " OCTOPAIR_VERSION);
    Command program = line.program();
    program.require_subcommand();
    program.set_examples({"octopair generate uniform --objects 1000000 -o boxes.npy",
                          "octopair detect boxes.npy -o pairs.npy", "octopair detect parts.glb --report clashes.html"});
    Action action;
    add_detect(program, action);
    add_generate(program, action);
#ifdef OCTOPAIR_WITH_VIEWER
    add_view(program, action);
#else
    add_missing_view(program);
#endif
    add_info(program, action);
    add_replay(program, action);
#ifdef OCTOPAIR_WITH_SERVICE
    add_serve(program, action);
    add_submit(program, action);
    add_status(program, action);
    add_result(program, action);
    add_cancel(program, action);
    add_drain(program, action);
#endif
    if (const auto status = line.parse(argc, argv)) return *status;
    return action();
}

}  // namespace

}  // namespace octopair::cli

int main(int argc, char** argv) {
    return octopair::cli::program_main("octopair", [&] { return octopair::cli::run(argc, argv); });
}
