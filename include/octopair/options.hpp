// Options: the settings of a call. All engines take the same ones.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

namespace [[gnu::visibility("default")]] octopair {

/// Order of the result. `ascending` sorts by a, then b. `octal` is the order of the linear octree, and is the cheapest. Both
/// are deterministic.
enum class Order : std::uint8_t { ascending, octal };

/// Receives the fraction of a call's work that is done, 0 to 1, which never decreases.
/// Thread safety: called by one thread at a time, not always the calling thread.
using ProgressSink = std::function<void(double)>;

struct Options {
    Order order = Order::ascending;
    double margin = 0;                        ///< largest gap, per axis, at which a pair counts; finite, >= 0
    std::optional<std::uint64_t> limit = {};  ///< maximum number of pairs; the first ones in `order` are returned
    std::uint64_t buffer_bytes = 1ull << 30;  ///< maximum memory for pairs while streaming; 1 MiB at least is used
    ProgressSink progress = {};               ///< may be empty; an exception ends the call and propagates to the caller
    /// True: a second algorithm that shares no code with the octree checks the result (docs/proofs.md, "Certificates").
    /// A list that fails the check is emptied. A stream fails before a wrong pair reaches the sink; a missing pair fails it at
    /// its end at the latest.
    /// Throws: Error{engine_failed} that names a wrong or missing pair; Error{usage} on an MPI engine, because no rank has all
    /// objects.
    /// Complexity: some microseconds per object, divided among the threads; often longer than the call. Memory of this process that
    /// does not depend on the number of pairs (docs/memory.md).
    bool verify = false;
};

}  // namespace octopair
