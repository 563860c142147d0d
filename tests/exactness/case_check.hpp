// CaseCheck: every call that an engine offers on one case, held against what it must find.
//
// Findings are values, not failures of a test: a search for failing scenes goes on with smaller ones, and tests of
// planted faults want to have some.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/cases.hpp"

namespace octopair::test {

/// What is wrong: which check found it, and what it found.
struct Finding {
    std::string check;
    std::string text;
};

/// All pairs of a case by the rule of objects.hpp, each tested: O(n^2).
std::vector<Pair> brute_force_pairs(const Case& a_case);
/// All pairs of a case by the second algorithm (src/verification).
std::vector<Pair> second_algorithm_pairs(const Case& a_case);

/// The engine to use where a case asks for so many threads (1 to 3).
using EngineFor = std::function<Engine&(unsigned threads)>;
/// Engines of this process, one for each number of threads, kept from case to case: what a call leaves behind must not
/// show in the next.
EngineFor local_engines();

/// How much of a case is asked.
enum class Calls : std::uint8_t {
    all,  ///< lists, limits, streams and counts, in both orders, with several numbers of threads
    few,  ///< a list in each order and a count
};

/// Makes calls on a case with `engines`; returns the first that is wrong. `expected`: all pairs, ascending.
std::optional<Finding> check_case(const Case& a_case, const std::vector<Pair>& expected, const EngineFor& engines,
                                  Calls calls = Calls::all);

}  // namespace octopair::test
