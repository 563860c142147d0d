// Small scenes with tiny tuning: the cases, and which paths they must have taken.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "base/test_hooks.hpp"
#include "exactness/case_check.hpp"

namespace octopair::test {

/// The i-th small case: 2 to 300 objects of a family, or of a kind with degenerate scenes. A pure function of `seed`.
Case small_case(std::uint64_t seed);

#ifdef OCTOPAIR_TEST_HOOKS

/// Sets the tuning of tests, and resets it at the end.
class TuningScope {
public:
    explicit TuningScope(const Tuning& tuning) { test_hooks().tuning = tuning; }
    ~TuningScope() { test_hooks().tuning = default_tuning; }
    TuningScope(const TuningScope&) = delete;
    TuningScope& operator=(const TuningScope&) = delete;
};

/// Plants a fault, and takes it out at the end.
class FaultScope {
public:
    explicit FaultScope(Fault fault) { test_hooks().fault = fault; }
    ~FaultScope() { test_hooks().fault = Fault::none; }
    FaultScope(const FaultScope&) = delete;
    FaultScope& operator=(const FaultScope&) = delete;
};

/// Checks small cases with their tunings; returns the first finding, with what replays it.
std::optional<Finding> check_small_cases(const SceneRange& seeds, const EngineFor& engines);

/// Counters of paths from 0 on, the usual tuning, no fault: also of processes that share a file.
void reset_test_hooks();

/// The names of those of these paths that were never taken. Prints how often each was.
std::string paths_not_taken(std::initializer_list<Path> paths);

#endif

}  // namespace octopair::test
