// Search: what a call does, as passes over the objects that each engine makes in its own way.
//
//   build      the linear octree of all objects, once a call
//   octal      scan once, pairs to a list or to the receiver as they come
//   ascending  scan into buckets and sort them, in the list or, for the receiver, in a buffer. Where the buffer is too
//              small: scan to count each object's pairs, then once for every window of objects whose pairs fit.
// With a limit, octal pairs are received one by one and the scan is abandoned after the first pair too many.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "boxes/box_source.hpp"
#include "engine/ascending_bounds.hpp"
#include "engine/pair_list.hpp"
#include "engine/progress.hpp"
#include "engine/request.hpp"

namespace octopair {

class Receiver;

/// What one call needs, beside the engine's own memory.
struct Call {
    const detail::Request& request;
    const detail::Output& output;
    const BoxSource& source;
    std::stop_source stop;  ///< asked to stop by the caller, and where a pass fails or is abandoned
    Progress& progress;
    Summary summary;

    std::uint64_t buffer_pairs() const;
};

/// Receives pairs on the calling thread.
using Deliver = std::function<void(std::span<const Pair>)>;

/// The passes of one call, in the order in which Search asks for them: build, then others. Each adds its times to the
/// summary and takes the progress to the fraction that it is given. All throw Error.
class Passes {
public:
    virtual ~Passes() = default;
    /// The call is over: lets go of what is the caller's.
    virtual void end() noexcept {}
    /// How many threads or workers share a pass.
    virtual unsigned width() const = 0;
    virtual void build(Call& call, double progress) = 0;
    /// How many pairs there are.
    virtual std::uint64_t count(Call& call, double progress) = 0;
    /// The pairs of each object as `a`.
    virtual void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) = 0;
    /// Appends to an empty list.
    virtual void list_octal(Call& call, detail::PairStorage& list, double progress) = 0;
    /// Holds at most call.buffer_pairs(). What `deliver` throws ends the pass and is passed on.
    virtual void stream_octal(Call& call, const Deliver& deliver, double progress) = 0;
    /// Appends to an empty list; throws OverBudget where the bounds say so.
    virtual void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
                                double progress) = 0;
};

class Search {
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
    /// Takes the progress to the fraction.
    void hand_out_held(Call& call, Receiver& receiver, double progress);
    template <typename Give>
    void receive(Call& call, Receiver& receiver, Give&& give);

    Passes& passes_;
    PairList held_;  // ascending pairs on their way to a receiver
};

}  // namespace octopair
