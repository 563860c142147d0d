// Tuning: every constant that chooses or bounds a path through the algorithm, in one place.
//
// The values were found by measurement on the scenes of docs/scenes.md. They change times, memory and the octal order,
// never the set of pairs or the ascending order.
//
// In a release the values are constants of the compiler, so reading them costs nothing. A build with test hooks
// (OCTOPAIR_TEST_HOOKS, test_hooks.hpp) reads them from memory that tests change between calls, and that worker
// processes share; tests make them tiny, so that a scene of a few boxes takes every path. A test may lower a value to 1
// unless its comment says otherwise. Values that size an array must not be raised.
//
// Constants that stand elsewhere, with their reasons:
//   formats of files and memory (recordings, what workers share, codes, keys, blocks of two cache lines): layout, not choice
//   widths of registers, the arithmetic of rounding, 8 entries a box: proofs depend on them
//   how far ahead memory is prefetched, how much is committed at once: no path depends on them
//   weights that share out work among ranks (engine/mpi/partition/octant_owners.cpp): any weights give the same result
//   timeouts, polls, retries of worker processes: tests of faults have plans of their own
//   what measured seconds decide (scene/scene_step.cpp): Scene::step switches it off
#pragma once

#include <cstddef>
#include <cstdint>

namespace octopair {

/// How a scene step chooses between a search around changed objects and a full one.
enum class StepChoice : std::uint8_t { measured, full, incremental };

struct Tuning {
    /// Which objects stand for all when the octree is planned (octree/linear_octree.cpp, octree/space.cpp).
    struct Sampling {
        std::size_t stride = 64;         ///< one object of so many, but
        std::size_t most = 1 << 21;      ///< at most so many objects, but
        std::size_t most_stride = 2048;  ///< one of so many at least: as many as crowd an octant
        std::size_t space = 4096;        ///< of the sample: enough for the quantiles of a space
    } sampling;

    /// When an octant is divided (octree/build/split_rule.cpp). In objects, unless a comment says otherwise.
    struct Split {
        double always = 2048;           ///< more would not stay in the cache while they are swept
        double never = 512;             ///< fewer are not divided, whatever their sweep costs; at most `always`
        double crowded_window = 40;     ///< objects that a sweep tests for each object
        double most_entries = 1.6;      ///< entries below an octant for each object that begins in it
        double handed_growth = 1.5;     ///< entries and boxes handed down, after a division against before
        std::uint64_t table_cells = 4;  ///< of the table from cells to leaves, for each octant
    } split;

    /// How the steps of a build are shared out (octree/linear_octree.cpp, octree/build/build_steps.cpp).
    struct Build {
        std::size_t blocks_per_thread = 2;       ///< each counts the entries of every octant
        std::size_t least_block = 2048;          ///< objects
        std::size_t counts_per_range = 1 << 16;  ///< to be merged; fewer are not worth sharing out
        std::size_t batch = 256;                 ///< objects loaded at a time: they stay in the first cache
    } build;

    /// How the octants of a linear octree are scanned (octree/scan.cpp).
    struct Scan {
        std::size_t large_node = 1 << 15;     ///< entries: an octant that all threads share
        std::size_t share_entries = 1 << 13;  ///< entries of a share at most, so that stops are seen soon
        std::size_t shares_per_thread = 64;
        std::size_t crowded_octant = 4096;      ///< entries: swept at once where the first axis does
        std::uint64_t good_tests = 192;  ///< tests a box
        double largest_part = 0.75;       ///< of the entries that one octant of a nested octree may hold
        double most_growth = 4;           ///< of entries in nested octrees, multiplied along a path of nesting
        unsigned most_nesting = 8;        ///< octrees within octants of octrees
    } scan;

    /// How sets of boxes are sorted and swept (octree/sweep/recursive_sweep.cpp, octree/sweep/sweep_order.cpp, sweep kernels).
    struct Sweep {
        std::size_t tile = 4096;               ///< boxes: their arrays stay in the second cache
        std::size_t small_set = 512;           ///< boxes: a sweep is good whatever its windows
        std::uint64_t cheap_tests = 64;       ///< tests a box
        std::uint64_t tests_per_pair = 16;     ///< two registers a pair
        std::size_t large_join = 1 << 15;      ///< boxes: shared out among threads
        std::size_t tests_per_call = 1 << 20;  ///< blocks of rows times registers of columns: a few milliseconds
        std::size_t hits = 1024;               ///< masks that a call of the kernel may write; at least 8
        std::size_t pairs = 2048;              ///< held before they are written
        std::size_t most_buckets = 4096;       ///< of a bucket sort, so that they stay in the first cache
        std::size_t few = 24;                  ///< boxes: so many at most are sorted by comparison
        std::size_t in_cache = 1 << 13;        ///< boxes: so many at most are sorted by buckets
        std::size_t radix_block = 1 << 16;     ///< keys of a share of a radix sort, at least
        unsigned radix_digit_bits = 11;        ///< of a digit of a radix sort: its counts stay in the first cache
        std::size_t measured_least = 256;      ///< boxes of a set that are looked at to measure it, at least, and
        std::size_t measured_most = 4096;      ///< at most
        std::size_t tried_rows = 16;           ///< rows that are tested against the measured columns to estimate hits
        std::size_t measured_row_stride = 13;        ///< rows of a set that is laid out, of which one window is measured
        std::size_t measured_rows = 24;              ///< measured at most
    } sweep;

    /// Octrees that change (octree/dynamic/mutable_octree.cpp, octree/dynamic/leaf_grid.cpp).
    struct Dynamic {
        std::size_t listed_visits = 128;  ///< units that a change may visit; with more it is made on its own
        std::size_t hits = 1 << 16;       ///< of a run of visits
        double cell_objects = 6;          ///< objects that a grid's cell should hold
        double most_growth = 2.2;         ///< entries for each object, where a grid cuts a leaf
        unsigned grid_bits = 18;          ///< of all axes of a grid together
    } dynamic;

    /// How pairs are kept, put in order and handed out (engine/). In pairs, unless a comment says otherwise.
    struct Output {
        std::uint64_t least_buffer = 1 << 20;  ///< bytes: what Options::buffer_bytes is raised to
        std::size_t batch = 1 << 13;           ///< small batches are put together before a sink gets them
        std::size_t handed_out = 1 << 16;      ///< at a time, so that progress grows in small steps
        std::size_t list_block = 1 << 15;      ///< of a PairList; at least 64 pages
        std::size_t page = 512;                ///< of a bucket of the ascending order
        unsigned bucket_row_bits = 12;         ///< objects of a bucket, as a power of two
        unsigned bucket_bits = 10;             ///< buckets at most, as a power of two
        unsigned bucket_split_bits = 6;        ///< parts of a bucket that is too large to be sorted at once
        std::size_t sorted_at_once = 1 << 18;
        std::size_t radix_from = 512;  ///< keys: fewer are sorted by comparison
        std::size_t shares_ahead = 4;  ///< of a stream, for each thread
    } output;

    /// Worker processes (engine/processes/).
    struct Processes {
        std::uint64_t objects_per_worker = 4096;  ///< at least: fewer are not worth another worker
        std::uint64_t worth_keeping = 1 << 15;    ///< pairs: fewer are copied, so that lists do not hold regions
        std::size_t kept_regions = 4;             ///< held by lists; further lists get copies
        std::uint64_t ring_block = 1 << 15;       ///< pairs of a block of a stream, at most
        unsigned blocks_at_once = 16;             ///< that the client takes before it looks at other things
        /// Bytes of the arena for each entry of a nested octree that workers share: a bound for homes (4), ghosts (32) and
        /// sorted entries (9 * 32), rounded up for the counts of octants. Must not be lowered.
        std::uint64_t nested_bytes = 512;
    } processes;

    /// MPI ranks (engine/mpi/).
    struct Ranks {
        std::uint64_t round_bytes = 16 << 20;  ///< dealt out before ranks look for a stop; at least 48
        std::size_t batch = 256;               ///< objects routed at a time
        std::size_t counted = 1 << 14;         ///< objects: so many tell where a rank's lie
        std::size_t block = 1 << 16;           ///< objects of a share
        std::size_t share_pairs = 1 << 16;     ///< to be sorted
        std::uint64_t octants = 1;             ///< dealt out to each rank, at least, where they can be divided
        std::size_t key_samples = 64;          ///< of a rank
        std::size_t relayed = 1 << 20;         ///< pairs of a message
        unsigned row_bin_bits = 14;            ///< bins of objects that pairs are counted by, as a power of two
    } ranks;

    /// Scenes (scene/).
    struct Scene {
        StepChoice step = StepChoice::measured;
        unsigned refills = 8;                   ///< of the octants of a former step
        double log_part = 0.125;                ///< of the objects may change before a step searches all, and
        double log_least = 256;                 ///< so many may in any scene
        std::uint64_t visits = 1 << 14;         ///< of units, for which there is memory in small scenes too
        std::uint64_t changed_pairs = 1 << 20;  ///< likewise
        std::size_t share_visits = 2048;        ///< of a thread's share
        std::size_t run_visits = 256;           ///< between looks at the limits
        std::uint64_t waiting_part = 16;        ///< one of so many pairs may wait to be merged into the list, but
        std::uint64_t waiting_least = 1 << 14;  ///< at least these
        std::size_t share_queries = 64;
    } scene;
};

inline constexpr Tuning default_tuning;

#ifdef OCTOPAIR_TEST_HOOKS
/// Returns the values that tests have set; at first, default_tuning. They must not change during a call.
const Tuning& tuning();
#else
constexpr const Tuning& tuning() { return default_tuning; }
#endif

}  // namespace octopair
