// Search: runs a call as a sequence of passes over the objects. Each engine implements the passes (passes.hpp).
//
//   build      Builds the linear octree of all objects, once in each call.
//   octal      Scans once. Passes pairs to the list or the receiver as they are found.
//   ascending  Scans into buckets and sorts these in the list or, for the receiver, in a buffer.
//              If the buffer is too small: scans to count each object's pairs, then scans once for each window of objects
//              whose pairs fit.
//
// With a limit, octal pairs go to the receiver, which ends the scan at the first pair beyond the limit.
#pragma once

#include "base/private_export.hpp"
#include "engine/passes.hpp"

namespace octopair {

class Receiver;

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
