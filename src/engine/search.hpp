// Search: runs a call as a sequence of passes over the objects. Each engine implements the passes (Passes).
//
//   build      Builds the linear octree of all objects, once in each call.
//   octal      Scans once. Passes pairs to the list or the receiver as they are found.
//   ascending  Scans into buckets and sorts these in the list or, for the receiver, in a buffer.
//              If the buffer is too small: scans to count each object's pairs, then scans once for each window of objects
//              whose pairs fit.
//
// With a limit, octal pairs go to the receiver, which ends the scan at the first pair beyond the limit.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "base/private_export.hpp"
#include "boxes/box_source.hpp"
#include "engine/ascending_bounds.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/request.hpp"

namespace octopair {

class Receiver;

/// State of one call, apart from the engine's own memory.
struct OCTOPAIR_PRIVATE_EXPORT Call {
    const detail::Request& request;
    const detail::Output& output;
    const BoxSource& source;
    std::stop_source stop;  ///< requested by the caller, or when a pass fails or is abandoned
    Progress& progress;
    Summary summary;

    /// Returns `Options::buffer_bytes` in pairs, but at least the minimum in tuning.hpp.
    std::uint64_t buffer_pairs() const;
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

class OCTOPAIR_PRIVATE_EXPORT Search {
public:
    explicit Search(Passes& passes) : passes_(passes) {}
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control);

private:
    void find(Call& call);
    void count(Call& call);
    void find_octal(Call& call);
    void find_ascending(Call& call);
    void collect_counted(Call& call, const AscendingBounds& bounds, double progress);
    void find_windows(Call& call, Receiver& receiver);
    /// Passes the pairs of `held_` to `receiver`. Advances the progress to the fraction `progress`.
    void hand_out_held(Call& call, Receiver& receiver, double progress);
    template <typename Give>
    void receive(Call& call, Receiver& receiver, Give&& give);

    Passes& passes_;
    PairList held_;  // ascending pairs that the receiver gets next
};

}  // namespace octopair
