// Scaling study on one machine: costs of a call for each of several ranks, in processor time.
//
// Efficiency is the efficiency of the critical path: seconds of one rank alone, over number of ranks times seconds of
// the slowest rank. Network time and waiting are left out.
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
    unsigned ranks_per_machine = 2;                           ///< only for Arrangement::paper
    std::vector<unsigned> ranks = {1, 2, 5, 10, 20, 40, 64};  ///< ascending, with 1
    unsigned rounds = 9;
    std::string mpirun = "mpirun";
};

/// Receives the current activity and the completed part, 0 to 1.
using Show = std::function<void(std::string_view activity, double done)>;

/// Runs this program under mpirun to measure. Throws: Error.
std::vector<Measured> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop);

/// Returns tables for people, or one JSON object for programs, ended by a newline.
std::string study_text(const std::vector<Measured>& all);
std::string study_json(const std::vector<Measured>& all);

}  // namespace octopair::cluster
