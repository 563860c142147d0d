// run_on_spawner(): runs a function on a thread that lives as long as this process.
//
// The system sends a worker its parent-death signal when the thread ends that started the worker, not only when the process ends.
// So workers are started on a thread that never ends.
#pragma once

#include <functional>

namespace octopair {

/// Runs `work` on the spawner thread and waits for it. In a process that was forked without that thread, runs it on this thread.
/// Requires: `work` does not throw. Throws: std::system_error if the thread cannot be started.
/// Thread safety: any thread may call it; one function runs at a time.
void run_on_spawner(const std::function<void()>& work);

}  // namespace octopair
