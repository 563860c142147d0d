// throw_if_stopped(): ends a step after a stop request of the caller.
#pragma once

#include <stop_token>

#include "base/test_hooks.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// Throws: Error{cancelled} if a stop was requested. Steps call this every few milliseconds.
inline void throw_if_stopped(const std::stop_token& stop) {
    if (stop.stop_requested() || is_stop_planned()) throw Error(ErrorCode::cancelled, "cancelled");
}

}  // namespace octopair
