// WorkerProcess: the client's handle of a worker process. Starts, polls and kills the process, and sends it messages.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include "base/descriptor.hpp"
#include "engine/processes/shared_memory/control_messages.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"

namespace octopair {

enum class ProcessState : std::uint8_t { runs, stopped, ended };

/// How a process ended.
struct ProcessEnd {
    std::string how;                ///< for messages
    bool lacked_resources = false;  ///< the system refused memory, a thread or a descriptor
};

class WorkerProcess {
public:
    /// Starts `program` for a slot.
    /// Throws: Error{resource_limit} if the system has no more processes or descriptors; Error{engine_failed} if the program
    /// cannot be run.
    WorkerProcess(const std::string& program, unsigned slot);
    /// Kills the process if it still runs.
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    /// Returns the current state of the process. Does not wait.
    ProcessState poll_state();
    /// Kills the process and waits for its end.
    ProcessEnd end();

    /// Sends a region unless it was sent before. Returns false if the message cannot be sent.
    bool send_region(std::uint32_t number, const SharedMemory& memory);
    /// Makes the worker drop the regions for which `wanted` is false.
    void forget_all_but(const std::function<bool(std::uint32_t)>& wanted);
    /// Sends a stop request for a pass. Returns false if the message cannot be sent.
    bool stop_pass(std::uint32_t pass);

private:
    bool is_stopped_in_proc() const;

    pid_t id_ = -1;
    unsigned polls_ = 0;
    pid_t owner_;        // process that started the worker; a child forked from it must not kill the worker
    Descriptor handle_;  // pidfd
    Descriptor socket_;
    std::set<std::uint32_t> regions_;  // regions that were sent
};

}  // namespace octopair
