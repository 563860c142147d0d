// Passes: the functions of an engine that a Search (search.hpp) calls. They build the octree of a call, and scan it into outputs.
// Start here to add a new engine.
//
// An engine is a class derived from Engine (octopair/engine.hpp) that owns its passes, a Search, a TicketLock and a JobQueue. The
// smallest one is in threads/local_engine.cpp.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <span>
#include <stop_token>

#include "base/tuning.hpp"
#include "boxes/box_source.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/pair_count.hpp"
#include "engine/pair_list.hpp"
#include "engine/pair_room.hpp"
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
    PairRoom* room = nullptr;  ///< room for the pairs of the call; null if they are only counted

    /// Returns `Options::buffer_bytes` in pairs, but at least the minimum in tuning.hpp.
    std::uint64_t buffer_pairs() const {
        return std::max(request.options.buffer_bytes, tuning().output.min_buffer_bytes) / sizeof(Pair);
    }
};

/// A Search calls these functions of an engine. It calls build() first, then scans. Each scan adds its times to the summary and advances the
/// progress to the fraction `progress`. Requires: lists are empty, and counts are 0.
///   width()            number of threads or workers that share a scan
///   build              builds the octree of the call's objects
///   count              returns the number of pairs. Stops when `limit` is reached
///   count_by_object    adds the number of pairs with object i as `a` to counts[i]
///   list_octal         appends all pairs in octal order. Throws OverBudget if `call.room` does, as does list_ascending
///   stream_octal       passes all pairs to `deliver` in octal order, and buffers at most call.buffer_pairs(). An exception of `deliver` ends it
///   list_ascending     appends the pairs within `bounds` in ascending order. Throws OverBudget if the pairs exceed `bounds.max_pairs`
///   end                ends the call: frees references to the caller's data
template <typename T>
concept Passes =
    requires(T passes, Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
             std::span<std::uint32_t> counts, const PairSink& deliver, double progress, const CountLimit& limit) {
        { passes.width() } -> std::same_as<unsigned>;
        passes.build(call, progress);
        { passes.count(call, progress, limit) } -> std::same_as<PairCount>;
        passes.count_by_object(call, counts, progress);
        passes.list_octal(call, list, progress);
        passes.stream_octal(call, deliver, progress);
        passes.list_ascending(call, list, bounds, progress);
        passes.end();
    };

}  // namespace octopair
