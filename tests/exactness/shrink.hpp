// Shrinking: from a failing case to a small one that still fails, and its text for a test.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "support/cases.hpp"

namespace octopair::test {

using Fails = std::function<bool(const Case&)>;

/// Leaves out objects of a failing case, half of them, a quarter and so on, as long as it still fails; stops after
/// `patience`. Requires: fails(a_case).
Case shrunk(Case a_case, const Fails& fails, std::chrono::seconds patience);

/// The boxes and options of a case as C++ that a test can hold; of a case with many objects only a description.
std::string as_test(const Case& a_case);

}  // namespace octopair::test
