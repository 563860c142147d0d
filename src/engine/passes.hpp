// Passes: the interface that each engine implements. Search (search.hpp) makes each kind of call from passes over the objects.
// Start here to add a new engine.
//
// An engine is a class derived from Engine (octopair/engine.hpp) that owns its passes, a Search, a TicketLock and a JobQueue. The
// smallest one is in threads/local_engine.cpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "base/private_export.hpp"
#include "base/tuning.hpp"
#include "boxes/box_source.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/request.hpp"

namespace octopair {

/// State of one call, apart from the engine's own memory.
struct Call {
    const detail::Request& request;
    const detail::Output& output;
    const BoxSource& source;
    std::stop_source stop;  ///< requested by the caller, or when a pass fails or is abandoned
    Progress& progress;
    Summary summary;

    /// Returns `Options::buffer_bytes` in pairs, but at least the minimum in tuning.hpp.
    std::uint64_t buffer_pairs() const {
        return std::max(request.options.buffer_bytes, tuning().output.min_buffer_bytes) / sizeof(Pair);
    }
};

/// Receives pairs on the calling thread.
using Deliver = std::function<void(std::span<const Pair>)>;

/// The passes of a call. Search calls build() first, then other passes. Each pass adds its times to the summary and advances
/// the progress to the fraction `progress`.
/// Throws: Error.
class OCTOPAIR_PRIVATE_EXPORT Passes {
public:
    virtual ~Passes() = default;
    /// Ends the call: frees references to the caller's data.
    virtual void end() noexcept {}
    /// Number of threads or workers that share a pass.
    virtual unsigned width() const = 0;
    virtual void build(Call& call, double progress) = 0;
    /// Returns the number of pairs.
    virtual std::uint64_t count(Call& call, double progress) = 0;
    /// Adds the number of pairs with object i as `a` to counts[i]. Requires: all counts are 0.
    virtual void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) = 0;
    /// Appends all pairs in octal order. Requires: `list` is empty.
    virtual void list_octal(Call& call, detail::PairStorage& list, double progress) = 0;
    /// Passes all pairs to `deliver` in octal order, and buffers at most call.buffer_pairs().
    /// Throws: what `deliver` throws, which ends the pass.
    virtual void stream_octal(Call& call, const Deliver& deliver, double progress) = 0;
    /// Appends the pairs within `bounds` in ascending order. Requires: `list` is empty.
    /// Throws: OverBudget if the pairs exceed `bounds.max_pairs`.
    virtual void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
                                double progress) = 0;
};

}  // namespace octopair
