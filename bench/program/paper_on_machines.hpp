// octopair-bench paper --machines: the paper's tables with several processors on each machine, on ranks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/command/command.hpp"
#include "program/study_output.hpp"

namespace octopair::bench {

struct MachinesRequest {
    std::vector<unsigned> machines;  ///< numbers of machines, ascending; empty: do not run on ranks
    std::optional<double> latency_seconds, bytes_per_second;  ///< parameters of the network model
    std::string mpirun = "mpirun";
};

/// Adds --machines, --latency, --bandwidth and --mpirun.
void add_machines_options(cli::Command& command, MachinesRequest& request);

/// The other options of `octopair-bench paper`.
struct MachinesScene {
    std::string scene;
    std::vector<std::uint64_t> objects;
    unsigned rounds;
    OutputRequest output;
};
/// Runs the study on ranks. Returns the exit status. Throws: Error.
int run_machines(const MachinesRequest& request, const MachinesScene& scene);

}  // namespace octopair::bench
