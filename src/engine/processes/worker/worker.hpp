// The main loop of a worker process: runs its part of each pass that the client requests, until the client has ended.
#pragma once

#include <functional>

#include "base/descriptor.hpp"
#include "engine/processes/worker/work_sharing.hpp"

namespace octopair {

/// File descriptor of a worker's socket to the client.
inline constexpr int worker_socket = 3;
/// Exit status of a worker for which the system has no memory, thread or descriptor.
inline constexpr int worker_lacks_resources = 5;

/// Serves `slot` and never returns. Calls `gone` on another thread when the client has ended; `gone` must end the process.
/// Throws: Error if the worker cannot attach to the client, or cannot map a region.
[[noreturn]] void run_worker(Descriptor socket, unsigned slot, ShareObserver* observer,
                             const std::function<void()>& gone);

}  // namespace octopair
