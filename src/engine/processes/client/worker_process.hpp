// WorkerProcess: a worker as the client sees it, from its start to its end.
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

/// What a look at a process can show.
enum class ProcessState : std::uint8_t { runs, stopped, ended };

class WorkerProcess {
public:
    /// Starts `program` for a slot. Throws Error{resource_limit} where the system has no process or descriptor to give,
    /// Error{engine_failed} where the program cannot be run.
    WorkerProcess(const std::string& program, unsigned slot);
    /// Ends it, if it has not ended.
    ~WorkerProcess();
    WorkerProcess(const WorkerProcess&) = delete;
    WorkerProcess& operator=(const WorkerProcess&) = delete;

    ProcessState look();
    /// Kills it and waits for its end; returns how it ended, in words.
    std::string end();

    /// Once each; false if the worker takes no message.
    bool send_region(std::uint32_t number, const SharedMemory& memory);
    /// Lets it forget the regions that are not `wanted`.
    void forget_all_but(const std::function<bool(std::uint32_t)>& wanted);
    bool stop_pass(std::uint32_t pass);

private:
    bool shown_as_stopped() const;

    pid_t id_ = -1;
    unsigned looks_ = 0;
    pid_t owner_;        // a process that this one forks may not end its workers
    Descriptor handle_;  // pidfd
    Descriptor socket_;
    std::set<std::uint32_t> regions_;
};

}  // namespace octopair
