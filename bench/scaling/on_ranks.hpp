// The side of the ranks: the calls that are measured.
#pragma once

#include <mpi.h>

#include <functional>
#include <stop_token>

#include "scaling/contest.hpp"

namespace octopair::scaling {

/// Runs a part on all ranks; throws on all, the same Error, if it threw on any.
using Together = std::function<void(const std::function<void()>&)>;

struct Turns {
    std::vector<Setup> setups;  ///< the first one is the local engine with one thread
    unsigned rounds = 7;
};

/// Collective: all setups take turns for so many calls, after one of each that is not counted, with engines and lists kept.
/// Those of the local engine run on the first rank, those of r ranks on the first r; ranks that have no part in a call sleep
/// meanwhile. Pairs are listed in octal order, and stay on the ranks that found them. The first rank returns `contest` with
/// all entrants. Throws Error{usage} if there are fewer ranks than a setup has, Error{engine_failed} if two setups find
/// different numbers of pairs of as many objects.
Contest hold_on_ranks(MPI_Comm comm, Contest contest, const Turns& turns, const Together& together,
                      const std::stop_token& stop);

}  // namespace octopair::scaling
