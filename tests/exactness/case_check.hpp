// check_case: makes the calls of an engine on one case and compares each result with the expected pairs.
//
// Findings are values, not test failures. The search for a smaller failing scene and the tests of planted faults both
// need them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/cases.hpp"

namespace octopair::test {

/// An error in a result: the check that found it, and the difference.
struct Finding {
    std::string check;
    std::string text;
};

/// Returns all pairs of a case by the rule of objects.hpp, from a test of every pair: O(n^2).
std::vector<Pair> brute_force_pairs(const Case& a_case);
/// Returns all pairs of a case by the second algorithm (src/verification).
std::vector<Pair> second_algorithm_pairs(const Case& a_case);

/// Returns the engine for a case with the given number of threads (1 to 3).
using EngineFor = std::function<Engine&(unsigned threads)>;
/// Returns engines of this process, one for each number of threads. The engines are reused for all cases, so that state
/// left by a call would show in the next case.
EngineFor local_engines();

/// The set of calls to make on a case.
enum class Calls : std::uint8_t {
    all,  ///< lists, limits, streams and counts, in both orders, with several numbers of threads
    few,  ///< a list in each order and a count
};

/// Makes calls on a case with `engines`. Returns the first wrong result. `expected`: all pairs, ascending.
std::optional<Finding> check_case(const Case& a_case, const std::vector<Pair>& expected, const EngineFor& engines,
                                  Calls calls = Calls::all);

}  // namespace octopair::test
