// The MPI engine: pairs are found by the ranks of an MPI program, each with a part of the objects.
//
// Calls     every call is collective: all ranks of the communicator make the same calls in the same order, with the same
//           options. Each gives its own slice of the objects (of each set, in a join); the slices in the order of the ranks
//           are the objects of the call, numbered on from rank to rank; at most 2^32 - 1 in all, but for find_pairs64. A
//           slice may be empty.
// Result    each rank receives a piece of the pairs, or streams it; the pieces in the order of the ranks are the same bytes
//           as from every engine. A Summary counts the pairs of all ranks; PairList::size() those of the piece.
// Errors    what is wrong on one rank ends the call on all, with the same Error; a stop request on one, too. A rank that
//           dies ends the program, as MPI has it.
// Threads   MPI must have been started with MPI_Init_thread: MPI_THREAD_FUNNELED for calls from the main thread,
//           MPI_THREAD_SERIALIZED from others, MPI_THREAD_MULTIPLE for jobs. Jobs run in the order in which they were
//           submitted, which must be the same on all ranks, and before calls that come after them.
// Memory    about 130 bytes an object of a rank's float32 boxes, beside input and output. Lists in ascending order are held
//           twice for a while. Options::buffer_bytes bounds what each rank holds while streaming, or the pairs of a 2^14th of
//           the objects if these are more.
// CMake     link octopair::mpi. Any MPI 3; all ranks on machines of one kind.
#pragma once

#include <mpi.h>

#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/arrangement.hpp"
#include "octopair/engine.hpp"
#include "octopair/input.hpp"

namespace octopair {

struct MpiOptions {
    unsigned threads = 1;  ///< of each rank; 0: one per core
    /// The same on all ranks. paper: the first rank, the master, gets all objects and deals them out in equal runs; each rank
    /// builds a sorted list; the first rank of each machine merges those of its machine; the master merges what they have,
    /// scans, on all of its threads, and has all pairs in its piece. It needs more memory than the local engine.
    Arrangement arrangement = Arrangement::shared;
    unsigned ranks_per_machine = 2;  ///< of Arrangement::paper, which takes so many in a row for a machine; from 1 on
};

/// Collective. The engine works on a duplicate of `comm` and must be destroyed on all ranks before MPI_Finalize. Throws Error{usage}
/// outside MPI_Init_thread and MPI_Finalize, and where the ranks' arrangements differ or machines have no ranks,
/// Error{engine_failed} if MPI fails.
std::unique_ptr<Engine> make_mpi_engine(MPI_Comm comm, const MpiOptions& options = {});

/// Collective: `pairs` of rank 0 becomes the pieces of all ranks, one after another; those of the others become empty.
/// Throws Error{usage} unless make_mpi_engine made the engine.
void gather_pairs(Engine& engine, PairList& pairs);

/// Two objects by their indices; a < b (in a join: a of the first set, b of the second).
struct Pair64 {
    std::uint64_t a, b;
    auto operator<=>(const Pair64&) const = default;
};

/// A rank's part of a set, borrowed. The set is in the order of `indices`, however it lies on the ranks.
struct IndexedObjects {
    Objects objects;
    /// One for each object, each but once in the set; on all ranks empty: 0, 1, ... from rank to rank.
    std::span<const std::uint64_t> indices = {};
};

using IndexedJoin = JoinOf<IndexedObjects>;
/// The objects of find_pairs64(): IndexedObjects, or IndexedJoin{first, second}.
using IndexedInput = InputOf<IndexedObjects>;

/// Collective: this rank's piece of the pairs, as find_pairs would give it for all objects in the order of their indices. For
/// indices of the caller's own, and for more objects than 2^32 - 1, of which a rank may have no more, with those that it
/// shares. Pairs beyond Options::limit are found and dropped. Throws as Engine::find_pairs; Error{bad_input} for an index that
/// is given twice; Error{usage} unless make_mpi_engine made the engine, not in the paper's arrangement.
Summary find_pairs64(Engine& engine, const IndexedInput& input, std::vector<Pair64>& pairs, const Options& options = {},
                     std::stop_token stop = {});

/// What the last call cost this rank. Seconds are processor time of the calling thread, without what it spent within MPI; so
/// they leave out waiting, and the other threads of a rank that has several.
struct RankCosts {
    double join = 0;   ///< to learn what all ranks ask for
    double plan = 0;  ///< the octants
    double route = 0;  ///< to find where objects go
    double pack = 0;   ///< what is sent
    double build = 0;  ///< the linear octree of what was received; in the paper's arrangement a sorted list
    double merge = 0;  ///< lists, in the paper's arrangement
    double scan = 0;   ///< pairs
    double order = 0;  ///< their ascending order
    double mpi = 0;    ///< within MPI, waiting included where it looks about
    std::uint64_t bytes_sent = 0, messages_sent = 0;
    std::uint64_t objects = 0;         ///< that this rank gave
    std::uint64_t shared_objects = 0;  ///< of these, how many went to several ranks
    std::uint64_t objects_received = 0;
};
/// Throws Error{usage} unless make_mpi_engine made the engine.
RankCosts last_costs(const Engine& engine);

}  // namespace octopair
