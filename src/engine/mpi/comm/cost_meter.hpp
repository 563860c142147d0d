// CostMeter: what a call costs this rank, step by step, without the time that it spends within MPI.
//
// Processor time of the calling thread: on a machine with fewer cores than ranks, the only time that means anything.
#pragma once

#include <ctime>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/mpi.hpp"

namespace octopair {

/// Seconds of this thread.
inline double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + double(now.tv_nsec) * 1e-9;
}

/// Adds what a block costs to a step's seconds, however the block is left.
class Metered {
public:
    Metered(const Communicator& comm, double& seconds) : comm_(comm), seconds_(seconds) {}
    Metered(const Metered&) = delete;
    Metered& operator=(const Metered&) = delete;
    ~Metered() { seconds_ += outside_mpi() - begin_; }

private:
    double outside_mpi() const { return thread_seconds() - comm_.traffic().cpu_seconds; }

    const Communicator& comm_;
    double& seconds_;
    double begin_ = outside_mpi();
};

}  // namespace octopair
