// Leading: rank 0 has the objects and makes the calls, the other ranks follow.
//
// On rank 0 an engine like those of one process: its caller knows nothing of ranks. Each call deals the objects out
// (dealing.hpp), has all ranks find pairs (rank_search.hpp), and receives them all, in order. The other ranks are in follow()
// as long as that engine lives.
#pragma once

#include <mpi.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "octopair/engine.hpp"

namespace octopair {

struct LeadingOptions {
    unsigned threads = 1;  ///< of each rank; 0: one per core
    /// That a rank may be silent while a call is under way, however long that takes; the same on all ranks.
    std::chrono::milliseconds silence{60'000};
    /// Told on rank 0, on the thread of a call or of the engine's end, of a rank that was silent for longer, before that call
    /// throws Error{engine_failed}. Calls that come after it wait for their stop: the program must end, by MPI_Abort.
    std::function<void(const std::string& what)> lost = {};
};

/// Throws Error{engine_failed} unless MPI was started with MPI_THREAD_SERIALIZED or more, which is what a leading engine needs.
void check_leading_threads();

/// Collective, with follow() on the other ranks of `comm`. The engine must go before MPI_Finalize. It may be used from any thread.
/// Throws Error{engine_failed} if MPI fails.
std::unique_ptr<Engine> make_leading_engine(MPI_Comm comm, const LeadingOptions& options = {});

/// Collective, with make_leading_engine() on rank 0. Takes part in its calls until it goes; sleeps in between. What goes wrong in
/// a call is told on rank 0. Throws as make_leading_engine().
void follow(MPI_Comm comm, const LeadingOptions& options = {});

}  // namespace octopair
