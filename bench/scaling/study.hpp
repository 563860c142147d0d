// Scaling by the clock: the local engine on 1, 2, 4 ... threads, and the MPI engine on as many ranks, on whatever machine
// this is.
//
// Strong scaling has the same objects for all, weak scaling as many for each core. All setups of a scene take turns in the
// processes of one mpirun, round by round, so that what else the machine does meets them alike.
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
    std::vector<unsigned> cores;                   ///< ascending, each once, 1 among them
    std::vector<unsigned> threads_per_rank = {1};  ///< likewise
    unsigned rounds = 7;
    std::string mpirun = "mpirun";
};

/// 1, 2, 4 ... and `most`.
std::vector<unsigned> doubled(unsigned most);

/// Told what is measured, and how much is done, 0 to 1.
using Show = std::function<void(std::string_view activity, double done)>;

/// Has the program measure itself under mpirun, once for each scene and number of objects. Throws Error.
std::vector<Contest> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop);

/// Tables for people; one JSON object for programs, ended by a newline.
std::string study_text(const std::vector<Contest>& all);
std::string study_json(const std::vector<Contest>& all);

}  // namespace octopair::scaling
