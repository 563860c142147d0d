// Summary: the counts and times of a call.
#pragma once

#include <cstdint>
#include <string_view>

namespace octopair {

/// Wall-clock seconds of the steps; a step that was passed over more than once (streaming) is summed.
struct StepSeconds {
    double encode = 0, sort = 0, merge = 0, scan = 0;
};

/// Outcome of Options::verify.
struct Verification {
    bool done = false;   ///< the result was checked, and no difference was found
    double seconds = 0;  ///< wall clock; not part of the seconds of the call
    /// Static text for users that names the properties which were not checked; empty if all were. Examples: the order of the
    /// pairs in octal order, which pairs are the first under a limit, which pairs were counted.
    std::string_view not_checked = {};
};

/// Counts and times of a call.
struct Summary {
    std::uint64_t pairs = 0;
    bool truncated = false;     ///< `limit` was reached and at least one more pair exists
    double seconds = 0;         ///< wall clock
    std::uint64_t entries = 0;  ///< of the linear octree; at most 8 an object
    StepSeconds steps = {};
    Verification verification = {};
};

}  // namespace octopair
