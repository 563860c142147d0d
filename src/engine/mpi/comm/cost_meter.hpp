// CostMeter: measures the processor time of each step of a call on this rank, without the time spent within MPI.
//
// Processor time of the calling thread is used, because wall-clock time is meaningless with fewer cores than ranks.
#pragma once

#include <ctime>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

/// Returns the processor time of this thread.
inline double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

/// Adds the processor time of its scope to `seconds`, also if an exception leaves the scope.
class CostMeter {
public:
    CostMeter(const Communicator& comm, double& seconds) : comm_(comm), seconds_(seconds) {}
    CostMeter(const CostMeter&) = delete;
    CostMeter& operator=(const CostMeter&) = delete;
    ~CostMeter() { seconds_ += outside_mpi() - begin_; }

private:
    double outside_mpi() const { return thread_seconds() - comm_.traffic().cpu_seconds; }

    const Communicator& comm_;
    double& seconds_;
    double begin_ = outside_mpi();
};

}  // namespace octopair
