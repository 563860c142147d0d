// The subcommands, one source file each. Each adds itself to the parser; its callback sets `action`, which does the
// work after parsing and returns the exit status. Both may throw Error.
#pragma once

#include <functional>

#include "cli/command/command.hpp"

namespace octopair::cli {

using Action = std::function<int()>;

void add_bench(Command& program, Action& action);
/// Of `bench`.
void add_bench_cluster(Command& bench, Action& action);
void add_bench_scaling(Command& bench, Action& action);
void add_cancel(Command& program, Action& action);
void add_detect(Command& program, Action& action);
void add_generate(Command& program, Action& action);
void add_info(Command& program, Action& action);
void add_replay(Command& program, Action& action);
void add_result(Command& program, Action& action);
void add_serve(Command& program, Action& action);
void add_status(Command& program, Action& action);
void add_submit(Command& program, Action& action);

}  // namespace octopair::cli
