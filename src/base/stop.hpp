// Stopping: what every step does when the caller asks to stop.
#pragma once

#include <stop_token>

#include "octopair/error.hpp"

namespace octopair {

/// Throws Error{cancelled} if a stop was requested. Called every few milliseconds of work.
inline void throw_if_stopped(const std::stop_token& stop) {
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
}

}  // namespace octopair
