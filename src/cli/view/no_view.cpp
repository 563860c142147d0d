// octopair view in a build without the viewer: says how to get it.
#include "cli/subcommands.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

void add_view(Command& program, Action&) {
    Command command = program.add_subcommand("view", "show a scene in a browser (not in this build)");
    command.ignore_other_arguments();
    command.callback([] {
        throw Error(
            ErrorCode::usage,
            "view: this octopair was built without the viewer; `scripts/run view INPUT` builds it, and so does CMake "
            "with -DOCTOPAIR_WITH_VIEWER=ON, which needs the commands node and npm (scripts/setup viewer)");
    });
}

}  // namespace octopair::cli
