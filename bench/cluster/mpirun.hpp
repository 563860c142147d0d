// Runs a command under mpirun.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

namespace octopair::cluster {

struct MpirunCommand {
    std::string mpirun;  ///< command with options, separated by spaces
    unsigned ranks = 1;
    std::vector<std::string> command;
};

/// Runs the command to its end; more ranks than cores and user root are allowed. Throws: Error{engine_failed} if the
/// command cannot start or fails; Error{cancelled} soon after a stop request.
void run_under_mpirun(const MpirunCommand& command, const std::stop_token& stop);

}  // namespace octopair::cluster
