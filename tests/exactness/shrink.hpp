// Shrinking: reduces a failing case to a small case that still fails, and prints that case as text for a test.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "support/cases.hpp"

namespace octopair::test {

using Fails = std::function<bool(const Case&)>;

/// Leaves out objects of a failing case, half of them, a quarter and so on, while the case still fails. Stops after
/// `patience`. Requires: fails(a_case).
Case shrunk(Case a_case, const Fails& fails, std::chrono::seconds patience);

/// Returns the boxes and options of a case as C++ code for a test. For many objects, returns only a description.
std::string as_test(const Case& a_case);

}  // namespace octopair::test
