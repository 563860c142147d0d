// Program octopair-bench: measures the paper's figure and tables, and the costs of a call by threads and ranks.
#include "cli/command/command.hpp"
#include "cli/command/program_main.hpp"
#include "octopair/version.hpp"
#include "program/subcommands.hpp"

namespace octopair::bench {

namespace {

int run(int argc, char** argv) {
    cli::CommandLine line("octopair-bench", "Measures octopair on this machine.", "octopair-bench " OCTOPAIR_VERSION);
    Command program = line.program();
    program.require_subcommand();
    program.set_examples({"octopair-bench paper --threads 2 --json paper.json"});
    Action action;
    add_paper(program, action);
#ifdef OCTOPAIR_WITH_MPI
    add_cluster(program, action);
    add_scaling(program, action);
#endif
    if (const auto status = line.parse(argc, argv)) return *status;
    return action();
}

}  // namespace

}  // namespace octopair::bench

int main(int argc, char** argv) {
    return octopair::cli::program_main("octopair-bench", [&] { return octopair::bench::run(argc, argv); });
}
