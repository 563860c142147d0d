// Machine and build of a measurement, for files of results.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace octopair::bench {

/// Returns `version`, `commit` ("unknown" outside a git checkout), `compiler`, `processor` and `cores`. No date:
/// results of equal builds on one machine are equal.
nlohmann::ordered_json machine_json();

}  // namespace octopair::bench
