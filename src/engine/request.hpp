// What every public call becomes: one Request, one Output, one Control, handed to Engine::run.
//
// The public calls check the options and the sizes before run is called; the boxes and the padding values themselves
// are checked by the engine on its first pass over them, so that a good input is read once less.
#pragma once

#include <optional>
#include <stop_token>

#include "octopair/engine.hpp"

namespace octopair::detail {

struct Request {
    const Objects& first;
    const Objects* second = nullptr;  ///< the other set of a join; null: pairs within `first`
    const Options& options;
};

/// Where pairs go: exactly one of the two is set; neither: they are counted only.
struct Output {
    PairList* list = nullptr;
    const PairSink* sink = nullptr;
};

/// Returns the request for an input. Borrows both arguments.
inline Request request_of(const Input& input, const Options& options) {
    return {input.first, input.second ? &*input.second : nullptr, options};
}

/// Options and sizes. Throws Error.
void check_request(const Request& request);

struct Control {
    std::stop_token stop;
    const ProgressSink& progress;
};

}  // namespace octopair::detail
