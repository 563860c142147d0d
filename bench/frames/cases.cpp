#include "frames/cases.hpp"

#include <utility>

namespace octopair::bench {

namespace {

const std::string full = "full detection";
const std::string all_pairs = "scene";
const std::string changes = "scene, changes only";
const std::string bullet = "Bullet dbvt";
const std::string bullet_deferred = "Bullet dbvt deferred";
const std::string fcl = "FCL AABB tree";
const std::string fcl_array = "FCL AABB tree, array";
const std::string ode = "ODE hash space";
const std::string ode_sweep = "ODE sweep and prune";

/// Cases of few objects, as in games and robot control. All or a tenth of them move.
std::vector<FrameCase> small_cases() {
    std::vector<FrameCase> cases;
    for (const std::uint64_t objects : {20, 200, 1'000, 5'000}) {
        for (const bool all_move : {true, false}) {
            FrameCase& one = cases.emplace_back();
            one.name = std::to_string(objects) + (all_move ? "-all" : "-tenth");
            one.objects = objects;
            one.share = all_move ? 1 : 0.1;
            one.threads = 1;
            one.trackers = {full, all_pairs, bullet, fcl};
            one.queries = 16;
            one.frames_factor = 10;
        }
    }
    return cases;
}

}  // namespace

std::vector<FrameCase> frame_cases() {
    std::vector<FrameCase> cases = {
        {"1m-percent", 1'000'000, 0.01, 1, {full, all_pairs, changes, bullet, fcl}},
        {"1m-permille", 1'000'000, 0.001, 1, {full, all_pairs, changes}},
        {"1m-all", 1'000'000, 1, 1, {full, all_pairs, changes, fcl, fcl_array}},
        {"100k-percent", 100'000, 0.01, 1, {full, all_pairs, bullet, bullet_deferred, fcl}},
        {"10k-all", 10'000, 1, 1, {full, all_pairs, bullet, bullet_deferred, fcl, fcl_array, ode, ode_sweep}},
        {"100k-all", 100'000, 1, 2, {full, all_pairs}},
    };
    for (FrameCase& one : small_cases()) cases.push_back(std::move(one));
    return cases;
}

}  // namespace octopair::bench
