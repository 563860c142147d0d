// One scene, all contenders: they take turns, round by round, so that what else the machine does meets them alike.
//
// The first run of each is not counted. Slow contenders run less often: until they have had their share of time.
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
    unsigned threads = 1;           ///< contenders that cannot use more than one are left out of more
    unsigned rounds = 7;
    unsigned least_rounds = 3;
    double most_seconds = 20;  ///< after which a contender rests, but not before `least_rounds`
    bool first = false;        ///< nothing but the first run
};

enum class RowState : std::uint8_t {
    measured,
    out_of_memory,  ///< some algorithms hold all candidates
    left_out        ///< too many objects for it (ContenderKind::most_objects)
};

struct Row {
    std::string contender;
    bool limit = false;
    std::uint64_t most_objects = 0;
    RowState state = RowState::measured;
    double first_seconds = 0;
    std::vector<double> seconds;  ///< in the order of the rounds
    Found found;
    bool agrees = true;  ///< with the first contender; a limit finds nothing and agrees

    double median() const;
};

/// Is told what has just been done.
using ComparisonProgress = std::function<void(std::string_view)>;

/// In the order of contender_kinds(); empty if no contender was asked for.
std::vector<Row> compare(const Scene& scene, const ComparisonPlan& plan, const ComparisonProgress& progress);

}  // namespace octopair::bench
