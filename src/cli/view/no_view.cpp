// octopair view in a build without the viewer: says how to get it.
#include <memory>
#include <string>
#include <vector>

#include "cli/subcommands.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

void add_view(Command& program, Action&) {
    Command command = program.add_subcommand("view", "show a scene in a browser (not in this build)");
    const auto words = std::make_shared<std::vector<std::string>>();
    command.add_option("INPUT", *words, "ignored");
    command.callback([words] {
        throw Error(
            ErrorCode::usage,
            "view: this octopair was built without the viewer; `scripts/run view INPUT` builds it, and so does CMake "
            "with -DOCTOPAIR_WITH_VIEWER=ON, which needs the commands node and npm (scripts/setup viewer)");
    });
}

}  // namespace octopair::cli
