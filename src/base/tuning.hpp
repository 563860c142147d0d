// Tuning: every constant that chooses or bounds a path through the algorithm, in one place. Tests count these paths (test_hooks.hpp).
//
// - The values were found by measurement on the scenes of docs/scenes.md.
// - They change times, memory and the octal order, never the set of pairs or the ascending order.
// - In a release they are compile-time constants, so reading them costs nothing.
// - A build with test hooks (OCTOPAIR_TEST_HOOKS, test_hooks.hpp) reads them from memory that worker processes share. Tests
//   change them between calls; with tiny values a scene of a few boxes takes every path.
// - A test may lower a value to 1 unless its comment says otherwise. Values that size an array must not be raised.
//
// Constants that are defined elsewhere, with their reasons:
//   formats of files and memory (recordings, memory shared with workers, octal codes, keys, blocks of two cache lines): they define a
//     layout, and choose no path
//   widths of registers, rows and columns that are tested together, slots of a row, the arithmetic of rounding, 8 entries per box:
//     kernels and proofs depend on them
//   prefetch distances, the amount of memory committed at once: no path depends on them
//   weights that distribute work among ranks (engine/mpi/partition/octree_planning.cpp, regional_owners.cpp): any weights give the same
//     result
//   timeouts, polling intervals, retries of worker processes: tests of faults have their own plans
//   decisions by measured seconds (scene/scene_step.cpp): Scene::step switches them off
#pragma once

#include <cstddef>
#include <cstdint>

namespace octopair {

/// How a scene step chooses between a search around changed objects (`incremental`) and a full search.
enum class StepChoice : std::uint8_t { measured, full, incremental };

struct Tuning {
    /// How objects are sampled when the octree is planned (octree/plan/octree_plan.cpp, octree/plan/space.cpp).
    struct Sampling {
        std::size_t stride = 64;            ///< one object in this many is sampled, within the limits below
        std::size_t min_objects = 16;       ///< minimum number of sampled objects, unless the call has fewer objects
        std::size_t max_objects = 1 << 21;  ///< maximum number of sampled objects, unless `max_stride` requires more
        std::size_t max_stride = 2048;      ///< one object in this many at least, beyond `max_objects` too
        std::size_t space_objects = 1024;   ///< maximum number of sampled objects whose quantiles give the space
    } sampling;

    /// When an octant is split (octree/plan/octree_plan.cpp). Numbers of objects, unless a comment says otherwise.
    struct Split {
        double always_above = 4096;              ///< an octant with more objects is split: their sweep misses the cache
        double never_up_to = 1024;               ///< an octant with at most this many stays whole; <= `always_above`
        double max_tests_per_object = 90;        ///< an octant is split if its sweep tests more others per object
        double max_entries_per_object = 1.6;     ///< maximum entries below an octant per object that begins in it
        double max_handed_growth = 1.5;          ///< maximum growth of entries and handed down boxes by a split
        std::uint64_t max_cells_per_octant = 4;  ///< maximum size of the table from cells to leaves
    } split;

    /// How the steps of a build are divided into shares (octree/build/linear_octree.cpp).
    struct Build {
        std::size_t blocks_per_thread = 2;       ///< blocks of objects; each block counts the entries of every octant
        std::size_t min_block = 2048;            ///< minimum number of objects per block
        std::size_t counts_per_range = 1 << 16;  ///< minimum number of merged counts per share
        std::size_t batch = 256;                 ///< objects loaded at a time, so that they stay in the L1 cache
        std::size_t max_chunk = 64;              ///< maximum entries per chunk of a list; a power of two, at least 16
        std::size_t chunk_part = 4;  ///< chunks shrink until at most one entry in this many can be unused; at least 1
    } build;

    /// Builds whose lists and tables exceed the caches and the TLB (octree/build/chunk_lists.cpp, octree/build/encoder_kernel.cpp).
    struct Large {
        std::size_t min_lists = 1 << 15;       ///< entries of at least this many lists are scattered in two passes
        std::size_t max_groups = 512;          ///< maximum number of groups of lists that the first pass scatters to
        std::size_t staged_per_list = 16;      ///< mean number of entries per list that are staged between the passes
        std::size_t stage_chunk = 256;         ///< staged entries per chunk of a group
        std::size_t max_near_table = 1 << 17;  ///< elements: a larger table of leaves is prefetched
    } large;

    /// How the octants of a linear octree are scanned (octree/scan).
    struct Scan {
        std::size_t large_octant = 1 << 15;       ///< an octant with more entries is scanned by all threads together
        std::size_t max_share_entries = 1 << 13;  ///< maximum entries per share: a stop request is noticed soon
        std::size_t shares_per_thread = 64;       ///< number of shares per thread
        std::size_t max_swept_list = 65535;       ///< maximum entries of a set that is swept on cells; do not raise
        std::uint64_t max_tests_per_box = 384;    ///< maximum number of tests per box in a sweep on cells
        double max_whole_crowd = 0.25;            ///< a part with more of an octree's entries is collected as ids
        double max_part_in_octant = 0.75;         ///< a nested octree with more of its entries in one octant is dropped
        double max_growth = 4;                    ///< maximum growth of entries: the product over nested octrees
        unsigned max_nesting = 8;                 ///< maximum depth of nesting: octrees within octants of octrees
    } scan;

    /// How sets of boxes are sorted and swept (octree/sweep/recursive_sweep.cpp, octree/sweep/start_order.cpp, sweep kernels).
    struct Sweep {
        std::size_t tile = 4096;               ///< boxes per tile: their arrays stay in the L2 cache
        std::size_t small_set = 512;           ///< a set of at most this many boxes is always swept
        std::uint64_t cheap_tests = 64;        ///< a sweep with at most this many tests per box is always good
        std::uint64_t tests_per_pair = 16;     ///< a sweep with at most this many per expected pair is good, too
        std::size_t large_join = 1 << 15;      ///< a join of more boxes is divided among threads
        std::size_t tests_per_call = 1 << 20;  ///< blocks of rows times groups of columns per call: some milliseconds
        std::size_t hits = 1024;               ///< masks of hits that a call of the kernel may write; at least 8
        std::size_t cell_hits = 2048;          ///< number of hits whose pairs are decided at a time; at least 320
        std::size_t cell_rows_per_call =
            4096;  ///< maximum rows per call of a sweep on cells, which then takes milliseconds
        std::size_t max_cell_buckets = 2048;    ///< maximum number of buckets of a sort by cells; a power of two
        std::size_t pairs = 2048;               ///< pairs that are buffered before they are written
        std::size_t max_buckets = 4096;         ///< maximum number of buckets: they stay in the L1 cache
        std::size_t max_comparison_sort = 24;   ///< up to this many boxes: comparison sort
        std::size_t max_bucket_sort = 1 << 13;  ///< up to this many boxes: bucket sort; more: radix sort
        std::size_t radix_block = 1 << 16;      ///< minimum number of keys per share of a radix sort
        unsigned radix_digit_bits = 11;         ///< bits per digit of a radix sort: the counts stay in the L1 cache
        std::size_t min_measured = 256;         ///< minimum number of boxes of a set that are sampled to measure it
        std::size_t max_measured = 4096;        ///< maximum number of boxes of a set that are sampled to measure it
        std::size_t tried_rows = 16;            ///< rows that are tested against the sampled columns to count hits
        std::size_t measured_row_stride = 13;   ///< one row in this many has its window measured
    } sweep;

    /// Octrees that are updated (octree/dynamic/mutable_octree.cpp, octree/dynamic/leaf_grid.cpp).
    struct Dynamic {
        std::size_t max_listed_visits = 128;     ///< maximum units that a change lists; a larger change is made alone
        std::size_t hits = 1 << 16;              ///< number of hits after which a run of visits stops
        double max_cell_objects = 6;             ///< maximum number of objects that a cell of a grid should hold
        double max_growth = 2.2;                 ///< maximum number of entries per object when a grid cuts a leaf
        unsigned max_grid_bits = 18;             ///< maximum number of bits of all axes of a grid together
        std::size_t range_entries = 1 << 12;     ///< maximum entries of a share of the build that has several octants
        std::size_t min_range_entries = 1 << 9;  ///< minimum entries of such a share in small octrees
    } dynamic;

    /// How pairs are stored, sorted and delivered (engine/). Numbers of pairs, unless a comment says otherwise.
    struct Output {
        std::uint64_t min_buffer_bytes = 1 << 20;       ///< bytes: minimum that Options::buffer_bytes is raised to
        std::size_t batch = 1 << 13;                    ///< smaller batches are collected before a sink receives them
        std::size_t max_pairs_per_sink_call = 1 << 16;  ///< from a list: more calls let progress grow in small steps
        std::size_t list_block = 1 << 15;               ///< minimum pairs per block of a PairList; at least 64 pages
        std::size_t page = 512;                   ///< pairs per page of a bucket of the ascending order; a power of two
        unsigned bucket_row_bits = 12;            ///< log2 of the number of objects per bucket
        unsigned bucket_bits = 10;                ///< log2 of the maximum number of buckets
        unsigned bucket_split_bits = 6;           ///< log2 of the number of parts of a bucket that is split
        std::size_t sorted_at_once = 1 << 20;     ///< a bucket with more pairs is split
        std::size_t bucket_pairs = 1 << 17;       ///< expected number of pairs per bucket, at most
        std::size_t slotted_pairs_per_row = 12;   ///< a bucket with more on average has no slots
        unsigned max_slotted_row_bits = 14;       ///< log2 of rows: slots of more rows exceed the L2 cache
        unsigned sparse_row_bits = 5;             ///< log2 of rows per pair: with more, pairs are sorted by comparison
        std::size_t bitmap_columns = 64;          ///< a row with a pair in one of this many columns uses a bit map
        std::size_t min_radix_sort = 512;         ///< keys; fewer keys are sorted by comparison, not by a radix sort
        std::uint64_t unchecked_bytes = 1 << 28;  ///< bytes: lists of fewer are not compared with the free memory
        std::uint64_t checked_step = 1 << 25;     ///< bytes by which a list grows between such comparisons
        std::uint64_t forecast_pairs = 1 << 27;   ///< pairs found before a search forecasts that all are too many
        double counting_seconds = 10;             ///< seconds after which pairs that are too many are not counted on
        std::size_t shares_ahead = 4;             ///< shares per thread that a stream computes ahead of the sink
    } output;

    /// Worker processes (engine/processes/).
    struct Processes {
        std::uint64_t objects_per_worker = 4096;  ///< minimum number of objects for which a further worker is used
        std::uint64_t worth_keeping = 1 << 15;    ///< a smaller result is copied, so its list keeps no shared memory
        std::size_t kept_regions = 4;        ///< maximum number of regions that lists hold; further lists get copies
        std::uint64_t ring_block = 1 << 15;  ///< maximum number of pairs per block of a stream
        unsigned blocks_at_once = 16;        ///< blocks that the client takes before its other work
        /// Arena bytes per entry of a nested octree that workers share: a bound for its entries (8 * 16) and the links of their
        /// chunks, with room for the lists of octants. Must not be lowered.
        std::uint64_t nested_bytes = 512;
    } processes;

    /// MPI ranks (engine/mpi/).
    struct Ranks {
        std::uint64_t round_bytes = 16 << 20;  ///< bytes exchanged between checks for a stop request; at least 48
        std::size_t batch = 256;               ///< objects routed at a time
        std::size_t block = 1 << 15;           ///< objects per share; at most 2^15: near positions rely on it
        std::size_t share_pairs = 1 << 16;     ///< pairs per share of the sort
        std::uint64_t octants = 8;  ///< minimum number of octants for each rank, if not all ranks store the octree
        /// Minimum number of objects on a rank for each octant of an octree that all ranks store. May be 0.
        std::uint64_t objects_per_octant = 3;
        double coordinates = 1 << 10;  ///< float32 coordinates per side of an octant; with fewer, the octant is fine
        double rounded_coordinates = 1 << 15;  ///< the same if boxes are rounded
        double max_fine_part = 0.125;          ///< boxes are sent if more of the octree's octants are fine leaves
        double max_inner_part = 0.25;          ///< boxes are sent if more of the entries are in inner octants
        unsigned calls_with_boxes = 100;       ///< calls that send boxes after a call in which entries were not enough
        unsigned part_of_ranks =
            4;  ///< objects are near each other if at most one rank in this many has much of an octant
        double crowd_part = 0.75;       ///< part of scan.max_tests_per_box from which boxes are fetched
        double core_part = 0.25;        ///< the same for octants that may have a dense core
        double handed_part = 0.25;      ///< the same for the number of entries that are handed down
        std::size_t key_samples = 64;   ///< sampled keys per rank
        std::size_t relayed = 1 << 20;  ///< pairs per message
        unsigned row_bin_bits = 14;     ///< log2 of the maximum number of bins of objects by which pairs are counted
    } ranks;

    /// Scenes (scene/).
    struct Scene {
        StepChoice step = StepChoice::measured;
        unsigned max_refills = 8;                ///< maximum number of refills of the octants of an earlier step
        double log_part = 0.125;                 ///< part of the objects that may change, in addition to `min_log`
        double min_log = 256;                    ///< objects that may change in any scene before a full search
        std::uint64_t visits = 1 << 14;          ///< unit visits that a step may make, plus half the number of objects
        std::uint64_t changed_pairs = 1 << 20;   ///< changed pairs that a step may find, plus the number of its pairs
        std::size_t share_visits = 2048;         ///< visits per share of a thread
        std::size_t run_visits = 256;            ///< visits between checks of the limits
        std::uint64_t waiting_part = 16;         ///< one changed pair per this many pairs may wait to be merged
        std::uint64_t min_waiting = 1 << 14;     ///< changed pairs that may wait in a scene of any size
        std::size_t share_queries = 64;          ///< queries per share
        std::size_t min_sorted_queries = 256;    ///< queries; fewer are answered in the order of the call
        std::size_t max_kept_answers = 1 << 20;  ///< answers of a call, beyond which their buffers are freed
        std::size_t exact_part = 1 << 14;        ///< pairs of enlarged boxes that a thread filters at a time
    } scene;
};

inline constexpr Tuning default_tuning;

#ifdef OCTOPAIR_TEST_HOOKS
/// Returns the values that tests have set, initially default_tuning. Requires: they do not change during a call.
const Tuning& tuning();
#else
constexpr const Tuning& tuning() { return default_tuning; }
#endif

}  // namespace octopair
