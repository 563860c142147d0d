// What measured: the machine and the build, as files of results say it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace octopair::bench {

/// `version`, `commit` ("unknown" where it was not built from one), `compiler`, `processor`, `cores`. No date: the same
/// build on the same machine says the same.
nlohmann::ordered_json machine_json();

}  // namespace octopair::bench
