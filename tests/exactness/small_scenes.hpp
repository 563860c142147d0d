// Small scenes with tiny tuning: makes the cases and reports the paths that they took.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "base/test_hooks.hpp"
#include "exactness/case_check.hpp"

namespace octopair::test {

/// Makes the i-th small case: 2 to 300 objects of a family, or of a kind with degenerate scenes. A pure function of
/// `seed`.
Case small_case(std::uint64_t seed);

#ifdef OCTOPAIR_TEST_HOOKS

/// Sets the tuning of tests in its constructor, and resets the tuning in its destructor.
class TuningScope {
public:
    explicit TuningScope(const Tuning& tuning) { test_hooks().tuning = tuning; }
    ~TuningScope() { test_hooks().tuning = default_tuning; }
    TuningScope(const TuningScope&) = delete;
    TuningScope& operator=(const TuningScope&) = delete;
};

/// Plants a fault in its constructor, and removes the fault in its destructor.
class FaultScope {
public:
    explicit FaultScope(Fault fault) { test_hooks().fault = fault; }
    ~FaultScope() { test_hooks().fault = Fault::none; }
    FaultScope(const FaultScope&) = delete;
    FaultScope& operator=(const FaultScope&) = delete;
};

/// Checks small cases with their tunings. Returns the first finding, with its replay command.
std::optional<Finding> check_small_cases(const SceneRange& seeds, const EngineFor& engines);

/// Resets the counters of paths, the tuning and the fault, for all processes that share the file of the hooks.
void reset_test_hooks();

/// Returns the names of the given paths that were never taken. Prints how often each path was taken.
std::string paths_not_taken(std::initializer_list<Path> paths);

#endif

}  // namespace octopair::test
