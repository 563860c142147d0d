// A command under mpirun.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

namespace octopair::cluster {

struct MpirunCommand {
    std::string mpirun;  ///< with options of its own, separated by spaces
    unsigned ranks = 1;
    std::vector<std::string> command;
};

/// Runs it to its end, with more ranks than cores and by root where need be. Throws Error{engine_failed} if it cannot be
/// started or fails, Error{cancelled} soon after a stop request.
void run_under_mpirun(const MpirunCommand& command, const std::stop_token& stop);

}  // namespace octopair::cluster
