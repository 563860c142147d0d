// The subcommands, one source file each. Each adds itself to the parser; its callback sets `action`, which does the
// work after parsing and returns the exit status. Both may throw Error.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace octopair::cli {

using Action = std::function<int()>;

void add_bench(CLI::App& app, Action& action);
/// Of `bench`.
void add_bench_cluster(CLI::App& bench, Action& action);
void add_bench_scaling(CLI::App& bench, Action& action);
void add_cancel(CLI::App& app, Action& action);
void add_detect(CLI::App& app, Action& action);
void add_generate(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_result(CLI::App& app, Action& action);
void add_serve(CLI::App& app, Action& action);
void add_status(CLI::App& app, Action& action);
void add_submit(CLI::App& app, Action& action);

}  // namespace octopair::cli
