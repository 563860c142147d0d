// One scene, all contenders: they take turns, round by round, so that other load on the machine affects all equally.
//
// The first run of each contender is not counted. Slow contenders run less often, because each has a time limit.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "peers/contender.hpp"
#include "peers/scenes.hpp"

namespace octopair::bench {

struct ComparisonPlan {
    std::vector<std::string> only;  ///< contenders by name; empty: all
    unsigned threads = 1;           ///< above 1, contenders with one thread are left out
    unsigned rounds = 7;
    unsigned min_rounds = 3;
    double max_seconds = 20;  ///< time limit of a contender, after `min_rounds` at least
    bool first = false;       ///< only the first run
};

enum class RowState : std::uint8_t {
    measured,
    out_of_memory,  ///< happens to algorithms that hold all candidates
    left_out        ///< too many objects (ContenderKind::max_objects)
};

struct Row {
    std::string contender;
    bool limit = false;
    std::uint64_t max_objects = 0;
    RowState state = RowState::measured;
    double first_seconds = 0;
    std::vector<double> seconds;  ///< in the order of the rounds
    Found found;
    bool agrees = true;  ///< equal to the first contender; true for a limit, which finds no pairs

    double median() const;
};

/// Receives the step that has just finished.
using ComparisonProgress = std::function<void(std::string_view)>;

/// Returns rows in the order of contender_kinds(); empty if no contender was selected.
std::vector<Row> compare(const Scene& scene, const ComparisonPlan& plan, const ComparisonProgress& progress);

}  // namespace octopair::bench
