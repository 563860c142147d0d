// Summary: the counts and times of a call.
#pragma once

#include <cstdint>
#include <string_view>

namespace [[gnu::visibility("default")]] octopair {

/// Wall-clock seconds of each step of a call, summed over repetitions of the step.
struct StepSeconds {
    double encode = 0;  ///< finds the octants of each box; the paper's encode
    double count = 0;   ///< counts the entries of each octant
    /// Appends the entries to the lists of their octants; the paper's sort. Encode and scatter run in one pass. A sample of batches is
    /// timed to divide the time of the pass.
    double scatter = 0;
    double scan = 0;  ///< finds the pairs; the paper's scan
};

/// Outcome of Options::verify.
struct Verification {
    bool done = false;   ///< true if the result was checked and no difference was found
    double seconds = 0;  ///< wall-clock time of the check; not part of Summary::seconds
    /// Names the properties that were not checked, for users; empty if all were. Examples: the order of the pairs in octal
    /// order, which pairs are the first under a limit, which pairs were counted. Static text.
    std::string_view not_checked = {};
};

/// Counts and times of a call.
struct Summary {
    std::uint64_t pairs = 0;
    bool truncated = false;     ///< true if `limit` was reached and at least one more pair exists
    double seconds = 0;         ///< wall-clock time of the call
    std::uint64_t entries = 0;  ///< number of entries in the linear octree; at most 8 per object
    StepSeconds steps = {};
    Verification verification = {};
};

}  // namespace octopair
