// Scaling by wall clock: the local engine on 1, 2, 4 ... threads, and the MPI engine on as many ranks, on the current
// machine.
//
// Strong scaling uses equal objects for all setups; weak scaling uses a fixed number of objects per core. All setups of
// a scene take turns in the processes of one mpirun, round by round. So other load on the machine affects all equally.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "scaling/contest.hpp"

namespace octopair::scaling {

struct StudyPlan {
    std::vector<std::string> scenes = {"uniform"};
    std::vector<std::uint64_t> objects = {1'000'000};
    bool weak = false;
    std::vector<unsigned> cores;                   ///< ascending, without repeats, with 1
    std::vector<unsigned> threads_per_rank = {1};  ///< ascending, without repeats, with 1
    unsigned rounds = 7;
    std::string mpirun = "mpirun";
};

/// Returns 1, 2, 4 ... and `most`.
std::vector<unsigned> doubled(unsigned most);

/// Receives the current activity and the completed part, 0 to 1.
using Show = std::function<void(std::string_view activity, double done)>;

/// Runs this program under mpirun, once for each scene and number of objects, to measure. Throws: Error.
std::vector<Contest> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop);

/// Returns tables for people, or one JSON object for programs, ended by a newline.
std::string study_text(const std::vector<Contest>& all);
std::string study_json(const std::vector<Contest>& all);

}  // namespace octopair::scaling
