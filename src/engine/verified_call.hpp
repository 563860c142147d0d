// VerifiedCall: a call with Options::verify. Checks the engine's result before the caller receives it, in the caller's process, with
// every engine.
//
// A list is checked when it is complete. A stream is checked batch by batch, before the caller's sink receives the batch. When the
// stream has ended, the verifier also checks that no pair is missing.
#pragma once

#include <functional>

#include "engine/request.hpp"

namespace octopair::detail {

/// Runs the call's search: its request, the output that receives the pairs, and the control.
using RunSearch = std::function<Summary(const Request&, const Output&, const Control&)>;

struct VerifiedCall {
    const Request& request;
    const Output& output;
    const Control& control;

    /// Calls `search` once and checks its result on `threads` threads of this process; 0: one per core.
    /// Throws: what `search` throws; Error{engine_failed} if the result is wrong. The caller must then empty the list.
    Summary run(unsigned threads, const RunSearch& search) const;
};

}  // namespace octopair::detail
