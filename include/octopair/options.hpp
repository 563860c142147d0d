// Options: the settings of a call, the same for all engines.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace octopair {

/// `octal`: the order of the linear octree, the cheapest. `ascending`: by a, then b. Both are deterministic.
enum class Order : std::uint8_t { ascending, octal };

/// Receives how much of a call is done, 0 to 1, never falling; from one thread at a time, which may not be the
/// caller's.
using ProgressSink = std::function<void(double)>;

struct Options {
    Order order = Order::ascending;
    double margin = 0;                        ///< gap up to which a pair counts, on every axis; finite, >= 0
    std::optional<std::uint64_t> limit = {};  ///< the first so many pairs of the order
    std::uint64_t buffer_bytes = 1ull << 30;  ///< bound on pairs held while streaming; at least 1 MiB is used
    ProgressSink progress = {};               ///< may be empty; what it throws ends the call and reaches the caller
    /// Checks the result by a second algorithm that shares no code with the octree (docs/design.md, "Certificates").
    /// A difference throws Error{engine_failed} that names a pair; of a list that failed, no pair is left. A stream fails
    /// before a pair that does not belong is handed out, and for want of a pair at its end at the latest.
    /// Time: some microseconds an object, shared by the threads; often ten times the call. Memory, in this process: 33
    /// bytes an object (64 for float64), 12 more in octal order; the number of pairs does not matter.
    /// Throws Error{usage} on an engine of MPI ranks, none of which has all objects.
    bool verify = false;
};

}  // namespace octopair
