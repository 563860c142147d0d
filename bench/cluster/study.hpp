// Scaling, as far as one machine can show it: what a call costs each of so many ranks in processor time.
//
// The efficiency is that of the critical path: the seconds of one rank alone, over number times seconds of the slowest of
// several. It leaves out what a network takes, and waiting.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "cluster/measured.hpp"

namespace octopair::cluster {

struct StudyPlan {
    std::vector<std::string> scenes = {"uniform"};
    std::vector<std::uint64_t> objects = {1'000'000};
    std::vector<Arrangement> arrangements = {Arrangement::shared};
    unsigned ranks_per_machine = 2;                           ///< of Arrangement::paper
    std::vector<unsigned> ranks = {1, 2, 5, 10, 20, 40, 64};  ///< ascending; 1 is among them
    unsigned rounds = 9;
    std::string mpirun = "mpirun";
};

/// Told what is measured, and how much is done, 0 to 1.
using Show = std::function<void(std::string_view activity, double done)>;

/// Has the program measure itself under mpirun. Throws Error.
std::vector<Measured> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop);

/// Tables for people; one JSON object for programs, ended by a newline.
std::string study_text(const std::vector<Measured>& all);
std::string study_json(const std::vector<Measured>& all);

}  // namespace octopair::cluster
