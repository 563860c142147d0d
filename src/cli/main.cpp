// The program octopair: parses the command line, and runs the chosen subcommand.
#include "cli/command/command.hpp"
#include "cli/command/program_main.hpp"
#include "cli/subcommands.hpp"
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
    add_view(program, action);
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
