// Leading engine: rank 0 has the objects and makes the calls; the other ranks follow.
//
// Rank 0     has an engine that its caller uses like an engine of one process. Each call distributes the objects to all ranks
//            (slice_distribution.hpp), runs the search on all ranks (rank_search.hpp), and receives all pairs, in order.
// Others     run follow() until the engine of rank 0 is destroyed.
#pragma once

#include <mpi.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "octopair/engine.hpp"

namespace octopair {

struct LeadingOptions {
    unsigned threads = 1;  ///< number of threads of each rank; 0: one per core
    /// Longest time that a rank may be silent during a call; the same on all ranks. A rank that works is not silent, so calls
    /// may take longer.
    std::chrono::milliseconds silence{60'000};
    /// Receives a message on rank 0 when a rank was silent for longer, before the current call throws Error{engine_failed}.
    /// Runs on the thread of that call, or of the engine's destructor. Later calls only wait for their stop request, so the
    /// program must end by MPI_Abort.
    std::function<void(const std::string& what)> on_silent_rank = {};
};

/// Throws: Error{engine_failed} unless MPI was started with MPI_THREAD_SERIALIZED or more, which a leading engine requires.
void check_leading_threads();

/// Collective: call on rank 0, with follow() on the other ranks of `comm`. Returns the engine of rank 0.
/// Requires: the engine is destroyed before MPI_Finalize. Throws: Error{engine_failed} if MPI fails.
/// Thread safety: any thread may use the engine.
std::unique_ptr<Engine> make_leading_engine(MPI_Comm comm, const LeadingOptions& options = {});

/// Collective: call on all ranks but rank 0, with make_leading_engine() on rank 0. Runs this rank's part of the engine's calls
/// until the engine is destroyed; sleeps between calls. The call on rank 0 reports the errors of all ranks.
/// Throws: as make_leading_engine().
void follow(MPI_Comm comm, const LeadingOptions& options = {});

}  // namespace octopair
