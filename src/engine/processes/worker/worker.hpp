// A worker process: does its part of each pass that the client asks for, until the client is gone.
#pragma once

#include <functional>

#include "base/descriptor.hpp"
#include "engine/processes/worker/work_sharing.hpp"

namespace octopair {

/// Where a worker finds its socket.
inline constexpr int worker_socket = 3;

/// Works in `slot`, forever; `gone` is called, on another thread, when the client is gone, and must end the process.
/// Throws Error where it cannot begin.
[[noreturn]] void run_worker(Descriptor socket, unsigned slot, ShareObserver* observer,
                             const std::function<void()>& gone);

}  // namespace octopair
