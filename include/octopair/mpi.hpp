// The MPI engine: the ranks of an MPI program find the pairs; each rank has a part of the objects.
//
// Calls     Every call is collective: all ranks of the communicator make the same calls in the same order with the same
//           options.
// Input     Each rank passes its own slice of the objects (of each set, in a join). A slice may be empty. The objects of the
//           call are all slices in rank order, numbered consecutively; at most 2^32 - 1, except for find_pairs64().
// Result    Each rank receives or streams a piece of the pairs. All pieces in rank order are the same bytes as from every
//           engine. A Summary counts the pairs of all ranks; PairList::size() those of the piece.
// Errors    An error or a stop request on one rank ends the call on all ranks, with the same Error. A rank that dies ends the
//           program, as usual in MPI.
// Threads   Requires MPI_Init_thread: MPI_THREAD_FUNNELED for calls from the main thread, MPI_THREAD_SERIALIZED for calls from
//           other threads, MPI_THREAD_MULTIPLE for jobs.
// Jobs      Jobs run in the order of submission, which must be the same on all ranks. A later direct call waits for them.
// Memory    Proportional to the rank's objects, besides input and output (docs/memory.md has the bytes). Lists in ascending
//           order are held twice for a while. A streaming rank holds at most Options::buffer_bytes of pairs, or the pairs of a
//           small part of the objects if these are more.
// CMake     Link octopair::mpi. Works with any MPI 3; all ranks must run on machines of one kind.
#pragma once

#include <mpi.h>

#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/input.hpp"

namespace [[gnu::visibility("default")]] octopair {

struct MpiOptions {
    unsigned threads = 1;  ///< threads of each rank, at most max_threads; 0: one per core
};

/// Returns an engine that uses a duplicate of `comm`. Collective.
/// Requires: all ranks destroy the engine before MPI_Finalize.
/// Throws: Error{usage} before MPI_Init_thread or after MPI_Finalize; Error{engine_failed} if MPI fails.
std::unique_ptr<Engine> make_mpi_engine(MPI_Comm comm, const MpiOptions& options = {});

/// Moves the pieces of all ranks, in rank order, to `pairs` of rank 0. The lists of the other ranks become empty. Collective.
/// Throws: Error{usage} if `engine` is not an MPI engine.
void gather_pairs(Engine& engine, PairList& pairs);

/// Indices of two objects; a < b (in a join: a is in the first set, b in the second).
struct Pair64 {
    std::uint64_t a, b;
    auto operator<=>(const Pair64&) const = default;
};

/// A rank's part of a set, borrowed. `indices` alone defines the order of the set, not the rank that has an object.
struct IndexedObjects {
    Objects objects;
    /// Index of each object, unique in the set. If empty on all ranks: 0, 1, ... in rank order.
    std::span<const std::uint64_t> indices = {};
};

using IndexedJoin = JoinOf<IndexedObjects>;
/// The objects of find_pairs64(): IndexedObjects, or IndexedJoin{first, second}.
using IndexedInput = InputOf<IndexedObjects>;

/// Stores this rank's piece of the pairs in `pairs`. All pieces, in rank order, are the pairs that find_pairs() would return for all
/// objects in the order of their indices. Use this function for indices of your own, or for more than 2^32 - 1 objects. Collective.
/// Throws: as Engine::find_pairs(); Error{resource_limit} if a rank has or receives more than 2^32 - 1 objects;
/// Error{bad_input} for an index that occurs twice; Error{usage} if `engine` is not an MPI engine.
/// Complexity: finds all pairs and then drops those beyond Options::limit.
Summary find_pairs64(Engine& engine, const IndexedInput& input, std::vector<Pair64>& pairs, const Options& options = {},
                     std::stop_token stop = {});

/// Costs of the last call on this rank. Seconds are CPU time of the calling thread outside of MPI. They include neither waiting
/// nor the work of a rank's other threads.
struct RankCosts {
    double join = 0;   ///< exchanges the requests of all ranks
    double plan = 0;   ///< plans the octants
    double route = 0;  ///< finds the ranks that receive each object, if boxes are sent
    double pack = 0;   ///< packs what is sent, and arranges what is received
    double build = 0;  ///< encodes this rank's objects; if boxes are sent, the received objects
    double scan = 0;   ///< finds the pairs
    double order = 0;  ///< sorts the pairs into ascending order
    double mpi = 0;    ///< CPU time inside of MPI calls, including time that MPI spends polling
    std::uint64_t bytes_sent = 0, messages_sent = 0;
    std::uint64_t objects = 0;  ///< number of objects in this rank's slices
    std::uint64_t shared_objects =
        0;  ///< number of objects in this rank's slices whose boxes were sent to several ranks
    std::uint64_t objects_received =
        0;                      ///< number of entries in this rank's octants; if boxes were sent, of received objects
    std::uint64_t octants = 0;  ///< number of octants that this rank stores
};
/// Returns the costs of the last call. Throws: Error{usage} if `engine` is not an MPI engine.
RankCosts last_costs(const Engine& engine);

}  // namespace octopair
