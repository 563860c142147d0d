// Request, Output, Control: the internal form of every public call, passed to Engine::run.
//
// The public calls check the options and the sizes before run() is called. The engine checks the boxes and the padding
// values in its first pass over them, which saves one read of a valid input.
#pragma once

#include <optional>
#include <stop_token>

#include "base/call_scope.hpp"
#include "base/private_export.hpp"
#include "octopair/engine.hpp"

namespace octopair::detail {

struct Request {
    const Objects& first;
    const Objects* second = nullptr;  ///< second set of a join; null: pairs within `first`
    const Options& options;
};

/// Destination of pairs. At most one of the two is set; if neither is set, pairs are only counted.
struct Output {
    PairList* list = nullptr;
    const PairSink* sink = nullptr;
    std::optional<std::uint64_t> max_pairs = {};  ///< pairs for which the sink has room; nothing: no bound
};

/// Returns the request for an input. Borrows both arguments.
inline Request request_of(const Input& input, const Options& options) {
    return {input.first, input.second ? &*input.second : nullptr, options};
}

/// Checks options and sizes.
/// Throws: Error{bad_input}, or Error{resource_limit} for too many objects.
OCTOPAIR_PRIVATE_EXPORT void check_request(const Request& request);

/// Returns a function that calls `progress` inside a CallbackScope of `call`. Any thread may call this function. Returns an empty function
/// if `progress` is empty. Borrows both arguments.
OCTOPAIR_PRIVATE_EXPORT ProgressSink callback_of(const CallScope& call, const ProgressSink& progress);

struct Control {
    std::stop_token stop;
    const ProgressSink& progress;
};

}  // namespace octopair::detail
