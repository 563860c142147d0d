// Measurement of calls on the ranks.
#pragma once

#include <mpi.h>

#include <functional>
#include <stop_token>

#include "scaling/contest.hpp"

namespace octopair::scaling {

/// Runs a part on all ranks. Throws: an equal Error on all ranks if the part threw on any rank.
using Together = std::function<void(const std::function<void()>&)>;

struct Turns {
    std::vector<Setup> setups;  ///< the first is the local engine with one thread
    unsigned rounds = 7;
};

/// Collective. All setups take turns for the given number of rounds, after one uncounted call each, with engines and
/// lists kept. The local engine runs on rank 0; a setup of r ranks runs on the first r. Ranks without a part in a call
/// sleep. Pairs are listed in octal order, and stay on the ranks that found them. Rank 0 returns `contest` with all
/// entrants. Throws: Error{usage} if there are fewer ranks than a setup has; Error{engine_failed} if two setups find
/// different numbers of pairs among equal numbers of objects.
Contest hold_on_ranks(MPI_Comm comm, Contest contest, const Turns& turns, const Together& together,
                      const std::stop_token& stop);

}  // namespace octopair::scaling
